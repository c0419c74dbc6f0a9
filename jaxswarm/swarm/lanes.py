"""How coordinates lie in memory where every one is computed for itself.

XLA on a CPU runs the loops of an elementwise step along the last axis of its result. Rows of a dozen
coordinates it unrolls and gathers lane by lane, which took two to three times as long as one pass over a
flat array. In a flat array, what belongs to a row (whether its value fell) or to a column (an attractor of
all) is found by dividing the index, and rows that fill the lanes of a processor do without: swarms of
2000 x 32 and of 200 x 64 take half the core-seconds as rows, 10000 x 50 four fifths; 1000 x 24 and
1000 x 30, which leave lanes empty, as much or more.
"""

import jax

__all__ = ["laned"]

FULL = 16
"""Coordinates that fill the lanes: rows of a multiple of it are kept."""
MANY = 40
"""Coordinates of a row beside which the lanes that it leaves empty do not count."""


def laned(a: jax.Array) -> jax.Array:
    """Return (..., n, d) as it is where rows are fast, else as (..., n d).

    >>> import jax.numpy as jnp
    >>> [laned(jnp.zeros((4, d))).shape for d in (13, 16, 30, 50)]
    [(52,), (4, 16), (120,), (4, 50)]
    """
    dims = a.shape[-1]
    return a if dims % FULL == 0 or dims >= MANY else a.reshape(*a.shape[:-2], -1)
