"""Order by counting: for some dozens of numbers quicker than a sort, alone and in many runs at once.

A sort on a CPU calls a comparison for every pair it looks at, microseconds for fifty numbers. That every
number counts those before it takes more comparisons, but all of them are one loop over vectors.
"""

import jax
import jax.numpy as jnp

__all__ = ["FEW", "ascending", "order", "place"]

FEW = 128
"""Numbers up to which they are counted: the square of more is more than what a sort looks at."""


def order(*keys: jax.Array) -> jax.Array:
    """Rows in rising order, (n,) int32; the first key counts most, ties keep their order.

    >>> order(jnp.array([2.0, 1.0, 2.0]), jnp.array([1.0, 0.0, 0.0])).tolist()
    [1, 2, 0]
    """
    n = keys[0].shape[0]
    if n > FEW:
        return jnp.lexsort(keys[::-1]).astype(jnp.int32)
    return _sorted(jnp.arange(n, dtype=jnp.int32), place(*keys))


def place(*keys: jax.Array) -> jax.Array:
    """Where each row comes in rising order, (n,) int32, for at most ``FEW``: the inverse of ``order``.

    >>> place(jnp.array([2.0, 1.0, 2.0]), jnp.array([1.0, 0.0, 0.0])).tolist()
    [2, 0, 1]
    """
    index = jnp.arange(keys[0].shape[0], dtype=jnp.int32)
    before = index[:, None] < index
    for key in reversed(keys):
        before = (key[:, None] < key) | ((key[:, None] == key) & before)
    return jnp.sum(before, axis=0, dtype=jnp.int32)


def ascending(value: jax.Array) -> jax.Array:
    """Numbers (n,) in rising order.

    >>> ascending(jnp.array([2.0, jnp.inf, 1.0])).tolist()
    [1.0, 2.0, inf]
    """
    return _sorted(value, place(value)) if value.shape[0] <= FEW else jnp.sort(value)


def _sorted(value, places):
    """Numbers (n,) put in their places, each of which is taken once: told, a scatter is a single pass."""
    blank = jnp.zeros_like(value)
    return blank.at[places].set(value, unique_indices=True, mode="promise_in_bounds")
