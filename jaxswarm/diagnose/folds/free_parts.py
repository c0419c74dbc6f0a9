"""What a model cannot imitate of the columns of many candidates, found for many at a time, and fits of it.

For each candidate by itself the factors of the folds, some megabytes, pass through the processor once a column.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from jaxswarm.decomposition import lstsq
from jaxswarm.diagnose.folds.partial_out import CrossFit, Fold

# Numbers of the columns that pass at a time: they stay in the cache beside the factors.
_AT_ONCE = 2**19
# A column of which no more than this part is free is one that the model has, as that of a rotor whose inertia
# the links take up: what is left of it is rounding, which as a candidate took 0.4 % off an error or none, by
# how sums were shared out. On practice log p02 columns have 5e-12 and less of their own, or 3e-3 and more.
_ROUNDING = 1e-7


def free_parts(
    candidates: Sequence[tuple[np.ndarray, ...]], crossfit: CrossFit
) -> Iterator[tuple[np.ndarray, ...]]:
    """The free part of every candidate's columns on every fold, in their order.

    Args:
        candidates: Of each the weighted columns (T, n, k), one array a fold.
        crossfit: The folds.
    """
    for part in at_once(candidates):
        yield from _together(candidates[part], crossfit)


def at_once(candidates: Sequence[tuple[np.ndarray, ...]]) -> Iterator[slice]:
    """Stretches of candidates whose columns pass together, of arguments as :func:`free_parts` has them."""
    start = numbers = 0
    for number, columns in enumerate(candidates):
        if number > start and numbers + columns[0].size > _AT_ONCE:
            yield slice(start, number)
            start, numbers = number, 0
        numbers += columns[0].size
    yield slice(start, len(candidates))


def _together(
    candidates: Sequence[tuple[np.ndarray, ...]], crossfit: CrossFit
) -> Iterator[tuple[np.ndarray, ...]]:
    if not candidates:
        return
    per_fold = zip(crossfit.folds, zip(*candidates, strict=True), strict=True)
    yield from zip(*(_of_fold(fold, columns) for fold, columns in per_fold), strict=True)


def _of_fold(fold: Fold, columns: Sequence[np.ndarray]) -> list[np.ndarray]:
    """The free parts of columns (T, n, k) on one fold."""
    shape = columns[0].shape[:2]
    # A column a row, so that each of them stands in one piece.
    rows = np.concatenate([c.reshape(-1, c.shape[2]).T for c in columns])
    known = fold.project.reshape(rows.shape[1], -1)
    inner = rows @ fold.basis.reshape(rows.shape[1], -1)
    size = np.linalg.norm(rows, axis=1)
    rows -= inner @ known.T
    rows[np.linalg.norm(rows, axis=1) <= _ROUNDING * size] = 0.0
    ends = np.cumsum([c.shape[2] for c in columns])[:-1]
    return [np.ascontiguousarray(part.T).reshape(*shape, -1) for part in np.split(rows, ends)]


def coefficients(free: np.ndarray, fold: Fold, residual: np.ndarray | None = None) -> np.ndarray:
    """Least-squares coefficients (k,) of free columns (T, n, k) on the training rows."""
    residual = fold.residual if residual is None else residual
    rows = free[fold.train].reshape(-1, free.shape[2])
    scale = np.linalg.norm(rows, axis=0)
    scale[scale == 0] = 1.0
    return lstsq(rows / scale, residual[fold.train].ravel(), rcond=1e-6) / scale
