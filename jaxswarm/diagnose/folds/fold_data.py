"""A joint on a fold as the compiled searches see it, and what columns explain there."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np


class FoldData(NamedTuple):
    """One joint on one fold, ready for a search: the rows of the joint only.

    Attributes:
        basis: Q of the joint's rows, (T', b), zero outside the training rows.
        residual: Weighted residual of those rows, (T',), zero outside the training rows.
        train: 1 on training rows, else 0, (T',).
    """

    basis: jax.Array | np.ndarray
    residual: jax.Array | np.ndarray
    train: jax.Array | np.ndarray


def decimate(x: jax.Array, taps: jax.Array, factor: int) -> jax.Array:
    """Decimate columns (T, k) like :class:`jaxswarm.logs.filtering.Decimator`, shape (T', k)."""
    size = taps.shape[0]
    kept = (x.shape[0] - size) // factor + 1
    spans = -(-size // factor)
    padded = jnp.pad(x, ((0, (kept + spans) * factor - x.shape[0]), (0, 0)))
    frames = padded.reshape(kept + spans, factor, -1)
    weights = jnp.pad(taps, (0, spans * factor - size)).reshape(spans, factor)
    parts = jnp.einsum("sf,tfk->stk", weights, frames)
    return jnp.asarray(sum(parts[s, s : s + kept] for s in range(spans)))


def explained(columns: jax.Array, fold: FoldData, positive: bool | jax.Array) -> jax.Array:
    """Sum of squares that free linear parameters of the columns (T', k) take off the residual.

    Columns of zeros say nothing. ``positive`` refuses a negative coefficient of the first column.
    """
    columns = columns * fold.train[:, None]
    inner = fold.basis.T @ columns
    gram = columns.T @ columns - inner.T @ inner
    size = jnp.sqrt(jnp.diag(columns.T @ columns)) + 1e-300
    gram = gram / size / size[:, None] + 1e-9 * jnp.eye(columns.shape[1])
    right = (columns.T @ fold.residual) / size
    refused = jnp.logical_and(positive, right[0] <= 0)
    gain: float | jax.Array = 0.0
    # Column after column, each freed of those before: for one to three of them a solver has no part to do.
    for k in range(columns.shape[1]):
        share = gram[k] / gram[k, k]
        gain += right[k] ** 2 / gram[k, k]
        right, gram = right - right[k] * share, gram - share[:, None] * gram[k]
    return jnp.where(refused, 0.0, gain)
