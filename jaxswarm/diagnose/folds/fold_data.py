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
    folds = jax.tree.map(lambda x: jnp.asarray(x)[None], fold)
    return explained_of(columns[None], folds, positive)[0, 0]


def explained_of(columns: jax.Array, folds: FoldData, positive: bool | jax.Array) -> jax.Array:
    """What :func:`explained` says of many columns (m, T', k) on all folds (S, ...): (S, m).

    One product for all of them: products of a few columns at a time take four times as long.
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
