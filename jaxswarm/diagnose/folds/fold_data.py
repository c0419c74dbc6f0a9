"""A joint on a fold as the compiled searches see it, and what columns explain there."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

# Rows of a decimated log that are made at a time: of 16 to 64 the fastest, for 160 taps.
_ROWS = 32


class FoldData(NamedTuple):
    """One joint on one fold, ready for a search: the rows of the joint only.

    Attributes:
        basis: Q of the joint's rows, (T', b), zero outside the training rows.
        residual: Weighted residual of those rows, (T',), zero outside the training rows.
        train: 1 on training rows, else 0, (T',).
        weight: Of the joint's rows, (T',), by which columns are to be multiplied; the same on every fold.
    """

    basis: jax.Array | np.ndarray
    residual: jax.Array | np.ndarray
    train: jax.Array | np.ndarray
    weight: jax.Array | np.ndarray


def decimate(x: jax.Array, taps: jax.Array, factor: int) -> jax.Array:
    """Decimate columns (T, k) like :class:`jaxswarm.logs.filtering.Decimator`, shape (T', k)."""
    return decimating(taps, factor)(x)


def decimating(taps: jax.Array, factor: int) -> Callable[[jax.Array], jax.Array]:
    """:func:`decimate` for columns that pass the same taps.

    Rows are made some at a time, as products with the taps written once for each of them: every number of the
    log is read a few times, and nothing longer than the log is written.
    """
    size, length = taps.shape[0], _ROWS * factor
    parts = -(-((_ROWS - 1) * factor + size) // length)
    tap = jnp.arange(parts * length) - factor * jnp.arange(_ROWS)[:, None]
    inside = jnp.logical_and(tap >= 0, tap < size)
    weights = jnp.where(inside, taps[jnp.clip(tap, 0, size - 1)], 0.0).reshape(_ROWS, parts, -1)

    def low(x: jax.Array) -> jax.Array:
        kept = (x.shape[0] - size) // factor + 1
        blocks = -(-kept // _ROWS)
        padded = jnp.pad(x, ((0, (blocks + parts) * length - x.shape[0]), (0, 0)))
        frames = padded.reshape(blocks + parts, length, -1)
        products = (
            jnp.einsum("rl,blk->brk", weights[:, p], frames[p : p + blocks]) for p in range(parts)
        )
        return jnp.asarray(sum(products)).reshape(blocks * _ROWS, -1)[:kept]

    return low


def explained(columns: jax.Array, folds: FoldData, positive: bool | jax.Array) -> jax.Array:
    """Sum of squares that free linear parameters of columns take off the residual of a fold: (S, m).

    Columns of zeros say nothing. One product for all: products of a few columns at a time take four times as
    long.

    Args:
        columns: Of m options, weighted, (m, T', k).
        folds: S of them, (S, ...).
        positive: Refuse a negative coefficient of the first column.
    """
    count, rows, width = columns.shape
    flat = jnp.moveaxis(columns, 1, 0).reshape(rows, count * width)
    # The residual beside the basis; both are zero outside the training rows.
    known = jnp.concatenate([folds.basis, folds.residual[:, :, None]], axis=2)
    inner = jnp.einsum("stb,tc->sbc", known, flat).reshape(len(known), -1, count, width)
    inner, right = inner[:, :-1], inner[:, -1]
    pairs = [(i, j) for i in range(width) for j in range(i + 1)]
    products = jnp.stack([columns[:, :, i] * columns[:, :, j] for i, j in pairs], axis=2)
    sums = jnp.einsum("st,mtp->smp", folds.train, products)
    squares = {i: sums[:, :, p] for p, (i, j) in enumerate(pairs) if i == j}
    # A column of zeros keeps its size: the compiler multiplies divisors, and the square of a tiny one is zero.
    size = {i: jnp.where(x > 0.0, jnp.sqrt(x), 1.0) for i, x in squares.items()}
    gram = {}
    for p, (i, j) in enumerate(pairs):
        left = sums[:, :, p] - (inner[..., i] * inner[..., j]).sum(axis=1)
        gram[i, j] = gram[j, i] = left / size[i] / size[j] + (1e-9 if i == j else 0.0)
    told = [right[:, :, i] / size[i] for i in range(width)]
    refused = jnp.logical_and(positive, told[0] <= 0)
    gain = jnp.zeros(told[0].shape)
    # Column after column, each freed of those before: for one to three of them a solver has no part to do.
    for k in range(width):
        gain += told[k] ** 2 / gram[k, k]
        share = {i: gram[k, i] / gram[k, k] for i in range(k + 1, width)}
        for i in range(k + 1, width):
            told[i] = told[i] - told[k] * share[i]
        gram |= {
            (i, j): gram[i, j] - share[i] * gram[k, j]
            for i in range(k + 1, width)
            for j in range(k + 1, width)
        }
    return jnp.where(refused, 0.0, gain)
