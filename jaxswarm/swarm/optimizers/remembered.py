"""Rows of a memory found again after an update, wherever the optimizer has put them."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.swarm.random import mix

__all__ = ["require_memory", "same_rows"]


def require_memory(state: Any, what: str) -> None:
    """Raise :class:`InputError` unless a state names its memory (``MEMORY``)."""
    if not hasattr(state, "MEMORY"):
        raise InputError(
            f"{what} needs an optimizer that remembers candidates, such as pso(), de() or ga(); "
            f"{type(state).__name__} names no memory."
        )


def same_rows(old: jax.Array, new: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Find every row of ``new`` in ``old``.

    Rows are compared by 32 bits made of all their bits, so that the (m, n) comparison is of numbers and
    not of rows; two rows of a thousand are mistaken for each other once in four thousand steps.

    Args:
      old: (n, d); new: (m, d), same dtype.

    Returns:
      Indices (m,) into ``old``, and whether (m,) the row is there at all.

    >>> old = jnp.array([[0.1, 0.2], [0.3, 0.4]])
    >>> [part.tolist() for part in same_rows(old, jnp.array([[0.3, 0.4], [0.4, 0.3]]))]
    [[1, 0], [True, False]]
    """
    equal = _digest(new)[:, None] == _digest(old)[None]
    return jnp.argmax(equal, axis=1), jnp.any(equal, axis=1)


def _digest(rows):
    words = jax.lax.bitcast_convert_type(rows, jnp.uint32)
    words = words.reshape(rows.shape[0], -1)
    place = mix(jnp.arange(words.shape[1], dtype=jnp.uint32) + np.uint32(0x9E3779B9))
    return jnp.sum(mix(words ^ place[None]), axis=1, dtype=jnp.uint32)
