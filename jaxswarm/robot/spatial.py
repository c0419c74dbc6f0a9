"""Vectors and matrices as tuples of scalars, so that rigid-body algebra fuses into plain loops.

A vector is a tuple of three *entries*, a matrix a tuple of three such rows. An entry is a Python
float where the number is known when the function is traced (a joint axis, a zero offset) and a JAX
array otherwise. Arithmetic folds the known zeros and ones away, so a robot with perpendicular axes
costs what its hand-written closed form costs, while one whose kinematics are traced (to
differentiate or batch over them) runs through the same code without folding.

Why not small arrays: under ``vmap`` a 3 x 3 product becomes a batched matrix product, which XLA on
a CPU runs one tiny call at a time; entry by entry the whole recursion is one elementwise loop over
the batch. Entries may have any (common) shape: with ``(num_lanes,)`` the particles of a swarm run
as lanes.

Reference: R. Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 2.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.experimental.xla_metadata import set_xla_metadata

Entry = Any  # float when known at trace time, else a JAX array, or a NumPy one along a log
# Three of them each, which no comprehension can promise.
Vector = tuple[Entry, ...]
Matrix = tuple[Vector, ...]
# An entry a joint, by its index.
ByJoint = Sequence[Entry] | jax.Array | np.ndarray

ZERO: Vector = (0.0, 0.0, 0.0)


def entries(array: Any, rank: int) -> Any:
    """Unpack the first ``rank`` axes of an array into nested tuples; known numbers become floats.

    Args:
        array: numpy or JAX array of at least ``rank`` axes; further axes are lanes. Tuples count as
            unpacked already, which lets known zeros stand beside lanes.
        rank: Number of axes to unpack.

    >>> entries(np.eye(2), 2)
    ((1.0, 0.0), (0.0, 1.0))
    """
    if rank == 0:
        return array
    if isinstance(array, tuple):
        return array
    if isinstance(array, jax.core.Tracer) or np.ndim(array) > rank:
        return tuple(entries(array[i], rank - 1) for i in range(array.shape[0]))
    return _as_floats(np.asarray(array).tolist())


def _as_floats(nested: Any) -> Any:
    return tuple(_as_floats(x) for x in nested) if isinstance(nested, list) else float(nested)


def is_zero(x: Entry) -> bool:
    """Tell whether an entry is known to be zero."""
    return isinstance(x, float) and x == 0.0


# Asked a million times along a log of six joints: each asks what it has to, and calls nothing for it.
def times(x: Entry, y: Entry) -> Entry:
    """Return x y; known zeros and ones cost nothing."""
    if isinstance(y, float):
        x, y = y, x
    if isinstance(x, float):
        if x == 0.0 or (isinstance(y, float) and y == 0.0):
            return 0.0
        if abs(x) == 1.0:
            return y if x == 1.0 else -y
    return x * y


def plus(x: Entry, y: Entry) -> Entry:
    """Return x + y; a known zero costs nothing."""
    if isinstance(x, float) and x == 0.0:
        return y
    return x if isinstance(y, float) and y == 0.0 else x + y


def minus(x: Entry, y: Entry) -> Entry:
    """Return x - y; a known zero costs nothing."""
    if isinstance(y, float) and y == 0.0:
        return x
    return -y if isinstance(x, float) and x == 0.0 else x - y


def total(terms: Iterable[Entry]) -> Entry:
    """Return the sum of entries, 0.0 if there are none."""
    result: Entry = 0.0
    for term in terms:
        result = plus(result, term)
    return result


def add(a: Vector, b: Vector) -> Vector:
    """Return a + b."""
    return tuple(plus(x, y) for x, y in zip(a, b, strict=True))


def subtract(a: Vector, b: Vector) -> Vector:
    """Return a - b."""
    return tuple(minus(x, y) for x, y in zip(a, b, strict=True))


def scale(s: Entry, a: Vector) -> Vector:
    """Return s a."""
    return tuple(times(s, x) for x in a)


def dot(a: Iterable[Entry], b: Iterable[Entry]) -> Entry:
    """Return the sum of products of two equally long sequences of entries."""
    result: Entry = 0.0
    for x, y in zip(a, b, strict=True):
        result = plus(result, times(x, y))
    return result


def cross(a: Vector, b: Vector) -> Vector:
    """Return a x b."""
    return (
        minus(times(a[1], b[2]), times(a[2], b[1])),
        minus(times(a[2], b[0]), times(a[0], b[2])),
        minus(times(a[0], b[1]), times(a[1], b[0])),
    )


def rotate(rotation: Matrix, a: Vector) -> Vector:
    """Return R a."""
    return tuple(dot(row, a) for row in rotation)


def transpose(rotation: Matrix) -> Matrix:
    """Return the transposed matrix."""
    return tuple(zip(*rotation, strict=True))


def rotate_back(rotation: Matrix, a: Vector) -> Vector:
    """Return R^T a."""
    return rotate(transpose(rotation), a)


def product(a: Matrix, b: Matrix) -> Matrix:
    """Return the matrix product A B."""
    columns = transpose(b)
    return tuple(tuple(dot(row, column) for column in columns) for row in a)


def add_matrices(a: Matrix, b: Matrix) -> Matrix:
    """Return A + B."""
    return tuple(add(x, y) for x, y in zip(a, b, strict=True))


def rotation_about(axis: Vector, sine: Entry, cosine: Entry) -> Matrix:
    """Return the rotation by an angle about a unit axis (Rodrigues), from its sine and cosine."""
    rows = []
    for i in range(3):
        row = []
        for j in range(3):
            along = times(axis[i], axis[j])
            entry = plus(along, times(cosine, minus(1.0 if i == j else 0.0, along)))
            if i != j:
                k = 3 - i - j
                turn = times(sine, axis[k])
                entry = minus(entry, turn) if (j - i) % 3 == 1 else plus(entry, turn)
            row.append(entry)
        rows.append(tuple(row))
    return tuple(rows)


def symmetric(ixx: Entry, ixy: Entry, iyy: Entry, ixz: Entry, iyz: Entry, izz: Entry) -> Matrix:
    """Return the symmetric matrix of six inertia entries in the order of the link parameters."""
    return ((ixx, ixy, ixz), (ixy, iyy, iyz), (ixz, iyz, izz))


def settle(entries: Any) -> Any:
    """Return the same entries, computed once and stored.

    XLA on a CPU fuses elementwise programs without limit and computes a value again for every
    consumer: a sine once for each entry it enters, and along a chain of n joints twice as often with
    every joint (six joints: 540 times slower). It does not look into a call that must not be inlined,
    so the recursion settles what it hands from one link to the next; elsewhere an optimization
    barrier says the same.

    Args:
        entries: Any nesting of entries; known numbers stay known.
    """
    leaves, structure = jax.tree.flatten(entries)
    free = [i for i, x in enumerate(leaves) if not isinstance(x, float)]
    if not free:
        return entries
    values = [leaves[i] for i in free]
    if all(isinstance(x, np.ndarray) for x in values):
        return entries  # NumPy computes where it stands
    if jax.default_backend() == "cpu":
        with set_xla_metadata(inlineable="false"):
            values = _same(*values)
    else:
        values = jax.lax.optimization_barrier(values)
    for i, value in zip(free, values, strict=True):
        leaves[i] = value
    return jax.tree.unflatten(structure, leaves)


@jax.jit
def _same(*values: jax.Array) -> tuple[jax.Array, ...]:
    return values


def stack(items: Iterable[Entry], like: jax.Array) -> jax.Array:
    """Stack entries along a new first axis, known numbers broadcast to the shape of ``like``."""
    return jnp.stack([jnp.broadcast_to(jnp.asarray(x, like.dtype), like.shape) for x in items])
