r"""Random numbers from a counter-based integer hash: one fused loop, nothing carried along.

A swarm needs many uniform numbers and does little with each, so on a CPU a cryptographic generator
costs several times the rest of the update. Here the number of lane ``i`` (the flat index in the
requested shape) of a stream with the words ``s0, s1`` is

    x = i 0x9e3779b9 + s0;   x ^= x >> 16;   x *= 0x7feb352d
    x ^= s1;                 x ^= x >> 15;   x *= 0x846ca68b
    u = (floor(x / 2^9) + 1/2) / 2^23  (float32),        u = 1/2 + (signed x + 1/2) / 2^32  (float64)

which is the 32-bit finalizer ``lowbias32`` of a Weyl sequence, keyed before and between its two
multiplications; its last step, x ^= x >> 16, mends low bits that ``u`` does not need, and is kept
for whole words (:meth:`Random.bits`). A rule that needs two numbers in a place
(:meth:`Random.uniforms`) shares the first multiplication: the others branch off with words of their
own in the place of ``s1`` and with shifts and factors of their own (with the same factor the
difference of two numbers took few values). The stream words are hashed more thoroughly (:func:`mix`
in a chain, once a stream) from both words of a JAX key and from the name of the stream, so every
purpose within a step has numbers of its own and :func:`fold` gives every step a key of its own. All
of it is elementwise integer arithmetic: XLA draws the numbers inside the loop that uses them, and
``vmap`` over keys adds an axis and no cost.

``u`` lies strictly inside (0, 1) and carries 23 (float32) or 32 (float64) random bits. This is a
statistical generator, not a cryptographic one; ``tests/swarm/test_random.py`` holds the evidence
(uniformity; serial, cross-lane, cross-stream, cross-step, cross-key, within-pair correlation), and
``random="threefry"`` in every optimizer draws from ``jax.random`` instead.

References:
    J. K. Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011 (counter-based
    generators); C. Wellons, "Prospecting for hash functions" (2018) (the constants of
    ``lowbias32`` and ``triple32``).
"""

import math
import zlib
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError, nearest
from jaxswarm.swarm.quantile import quantile

__all__ = ["Random", "SOURCES", "check_source", "fold", "lead_of", "mix"]

BRANCHES = ((15, 0x846CA68B), (17, 0xED5AD4BB), (11, 0xAC4C1B51))
"""Shift and factor of the last multiplication, for up to three numbers from one hash."""


def mix(x: jax.Array) -> jax.Array:
    """Scramble 32-bit words: every input bit flips every output bit with probability near 1/2.

    Args:
      x: uint32, any shape.

    Returns:
      uint32, same shape; the map is one to one.

    >>> [int(mix(jnp.uint32(i))) for i in (0, 1, 2)]
    [0, 1753845952, 3507691905]
    """
    x = x ^ (x >> 16)
    x = x * np.uint32(0x7FEB352D)
    x = x ^ (x >> 15)
    x = x * np.uint32(0x846CA68B)
    return x ^ (x >> 16)


def fold(key: jax.Array, data: int | jax.Array) -> jax.Array:
    """Derive a key from a key and a number, like ``jax.random.fold_in`` in a few instructions.

    Args:
      key: a JAX key, typed (``jax.random.key``) or raw (``jax.random.PRNGKey``).
      data: integer scalar, such as the step count.

    Returns:
      A key of the same kind.

    >>> key = jax.random.key(0)
    >>> fold(key, 1) == fold(key, 1), fold(key, 1) == fold(key, 2)
    (Array(True, dtype=bool), Array(False, dtype=bool))
    """
    words = _words(key)
    data = jnp.asarray(data).astype(jnp.uint32)
    s0 = mix(words[0] ^ mix(data + np.uint32(0x9E3779B9)))
    s1 = mix(words[1] + mix(s0 + data))
    new = jnp.stack([s0, s1, *words[2:]])
    if jnp.issubdtype(key.dtype, jax.dtypes.prng_key):
        return jax.random.wrap_key_data(new, impl=jax.random.key_impl(key))
    return new


def lead_of(keys: Any) -> tuple[int, ...]:
    """Shape of an array of JAX keys, typed or raw: () of a single one.

    Raises:
      InputError: something else, such as a seed or a list.
    """
    if not isinstance(keys, jax.Array | np.ndarray):
        raise InputError(f"key={keys!r} is no JAX key: pass jax.random.key(0).")
    typed = jnp.issubdtype(keys.dtype, jax.dtypes.prng_key)
    return keys.shape if typed else keys.shape[:-1]


class Random:
    """The random numbers of one step: named streams drawn from one key.

    Args:
      key: a JAX key, typed or raw; the same key gives the same numbers.
      source: ``"hash"`` (default) or ``"threefry"``; see :data:`SOURCES`.

    >>> random = Random(jax.random.key(0))
    >>> random.uniform("social", (2,), jnp.float32).shape
    (2,)
    """

    def __init__(self, key: jax.Array, source: str = "hash"):
        self.key = key
        self.source = source

    def child(self, index: int | jax.Array) -> "Random":
        """Independent numbers for a part that numbers its own streams."""
        return Random(fold(self.key, index), self.source)

    def bits(self, stream: str, shape: tuple[int, ...] = ()) -> jax.Array:
        """32 random bits an element: uint32 of the given shape."""
        word = self._draw(stream, shape, 1)[0]
        return word ^ (word >> 16)

    def uniform(self, stream: str, shape: tuple[int, ...] = (), dtype=float) -> jax.Array:
        """Numbers uniform in the open interval (0, 1)."""
        return self.uniforms(stream, 1, shape, dtype)[0]

    def uniforms(
        self, stream: str, num: int, shape: tuple[int, ...] = (), dtype=float
    ) -> list[jax.Array]:
        """``num`` (1 to 3) arrays of independent uniform numbers, cheaper than as many streams."""
        return [_to_unit(word, jnp.result_type(dtype)) for word in self._draw(stream, shape, num)]

    def normal(self, stream: str, shape: tuple[int, ...] = (), dtype=float) -> jax.Array:
        """Standard normal numbers, by inversion of a uniform one: |z| < 5.3 (float32), 6.3 (float64)."""
        return quantile(self.uniform(stream, shape, dtype))

    def cauchy(self, stream: str, shape: tuple[int, ...] = (), dtype=float) -> jax.Array:
        """Standard Cauchy numbers, tan(pi (u - 1/2))."""
        return jnp.tan(math.pi * (self.uniform(stream, shape, dtype) - 0.5))

    def integers(self, stream: str, shape: tuple[int, ...], upper: int | jax.Array) -> jax.Array:
        """Integers 0 ... upper - 1 (int32); the bias is below upper / 2^23."""
        u = self.uniform(stream, shape, jnp.float32)
        scaled = u * jnp.asarray(upper, jnp.float32)
        return jnp.minimum(scaled.astype(jnp.int32), jnp.asarray(upper, jnp.int32) - 1)

    def permutation(self, stream: str, size: int) -> jax.Array:
        """A random order of 0 ... size - 1 (int32)."""
        return jnp.argsort(self.bits(stream, (size,))).astype(jnp.int32)

    def others(self, stream: str, size: int, count: int) -> jax.Array:
        """For each of ``size`` members, ``count`` distinct others: int32 (size, count), uniform.

        The j-th draw is taken among the ``size - 1 - j`` members not yet excluded and then shifted
        past the excluded ones in rising order, so no draw is ever rejected.
        """
        excluded = jnp.arange(size, dtype=jnp.int32)[:, None]
        for j in range(count):
            pick = self.integers(f"{stream}/{j}", (size,), size - 1 - j)
            for column in jnp.sort(excluded, axis=1).T:
                pick = pick + (pick >= column).astype(jnp.int32)
            excluded = jnp.concatenate([excluded, pick[:, None]], axis=1)
        return excluded[:, 1:]

    def _draw(self, stream, shape, num):
        return SOURCES[self.source](self.key, zlib.crc32(stream.encode()), tuple(shape), num)


def check_source(source: str) -> str:
    """Return ``source`` if it is a known source of random bits, else raise :class:`InputError`."""
    if source not in SOURCES:
        raise InputError(f"random={source!r} is no source of numbers. {nearest(source, SOURCES)}")
    return source


def _hashed_bits(key, tag, shape, num):
    words = _words(key)
    s0 = mix(words[0] ^ np.uint32(tag))
    s1 = mix(words[1] + s0)
    for word in words[2:]:
        s1 = mix(s1 ^ word)
    x = _sequence(shape, s0)
    x = (x ^ (x >> 16)) * np.uint32(0x7FEB352D)
    drawn = []
    for shift, factor in BRANCHES[:num]:
        y = x ^ s1
        drawn.append((y ^ (y >> shift)) * np.uint32(factor))
        s1 = mix(s1 ^ np.uint32(0x9E3779B9))
    return drawn


def _threefry_bits(key, tag, shape, num):
    return list(jax.random.bits(jax.random.fold_in(key, tag), (num, *shape), jnp.uint32))


SOURCES: dict[str, Callable[[jax.Array, int, tuple[int, ...], int], list[jax.Array]]] = {
    "hash": _hashed_bits,
    "threefry": _threefry_bits,
}
"""Sources: name -> function of (key, stream number, shape, num) giving ``num`` arrays of uint32 whose
upper bits are random."""


def _words(key: jax.Array) -> list[jax.Array]:
    lead_of(key)
    data = jax.random.key_data(key) if jnp.issubdtype(key.dtype, jax.dtypes.prng_key) else key
    if data.ndim != 1 or data.dtype != jnp.uint32 or data.shape[0] < 2:
        raise InputError(
            f"key has shape {key.shape} and dtype {key.dtype}: pass one JAX key "
            "(jax.random.key(0)), and use jax.vmap for many."
        )
    return [data[i] for i in range(data.shape[0])]


def _sequence(shape: tuple[int, ...], start: jax.Array) -> jax.Array:
    """Return i 0x9e3779b9 + start for the flat index i, from a short sequence an axis."""
    total, stride = start, 0x9E3779B9
    for axis in reversed(range(len(shape))):
        steps = jax.lax.iota(jnp.uint32, shape[axis]) * np.uint32(stride)
        total = total + steps.reshape(*(1,) * axis, -1, *(1,) * (len(shape) - 1 - axis))
        stride = stride * shape[axis] % 2**32
    return total


def _to_unit(bits: jax.Array, dtype: jnp.dtype) -> jax.Array:
    # Signed conversions: vector units convert int32, not uint32. Both forms are exact.
    if dtype == jnp.float64:
        signed = jax.lax.bitcast_convert_type(bits, jnp.int32).astype(dtype)
        return signed * 2.0**-32 + (0.5 + 2.0**-33)
    signed = (bits >> 9).astype(jnp.int32).astype(jnp.float32)
    return (signed * np.float32(2.0**-23) + np.float32(2.0**-24)).astype(dtype)
