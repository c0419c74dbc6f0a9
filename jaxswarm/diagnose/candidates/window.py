r"""The stretch of a log in which the last link carried another body.

Columns X that act within a window only are worth what they explain of the residual r beside all that the model
holds, with Q its basis: :math:`h^T (X^T X - P^T P)^{-1} h` with :math:`h = X^T r` and :math:`P = Q^T X`. With
running sums of the three that is a small linear solution for every window, and all are tried.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from jaxswarm.decomposition import thin_svd
from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.folds.partial_out import Fold
from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.lengths import filled

# Points of time per log between which windows lie, on the first look and on the second around the best,
# and the least share of a log that a window holds: two of the blocks that decide on it.
_EDGES, _FINE, _LEAST = 48, 16, 0.1
# Directions of the body weaker than this part of the strongest are not seen; what keeps sums solvable.
_RANK, _RIDGE = 1e-5, 1e-9


def windowed_candidate(lin: Linearization, term: Term, columns: np.ndarray) -> Candidate | None:
    """A body carried for a while, in the window that explains most of each fold's residual.

    Args:
        lin: The model, linearized.
        term: Of a :class:`BodyChange` with a window.
        columns: Weighted columns (T, n, 10) of the body if it were carried all along.
    """
    rows = columns.reshape(-1, columns.shape[2])
    scale = np.maximum(np.linalg.norm(rows, axis=0), 1e-300)
    _, size, directions = thin_svd(rows / scale)
    seen = columns / scale @ directions[size > _RANK * size[0]].T
    # A log in which a load is known has no second one: its columns are those of the first.
    known = {t.values["log"] for t in lin.found.model.terms if t.place == term.place}
    logs = [n for n in np.unique(lin.found.regression.log) if n not in known]
    windows = [_best_window(lin, fold, seen, logs) for fold in lin.crossfit.folds]
    found = [window for window in windows if window is not None]
    if len(found) < len(windows):
        return None
    bounds = {p.name: (p.lower, p.upper) for p in term.law.nonlinear}
    values = [{n: float(np.clip(x, *bounds[n])) for n, x in v.items()} for v in found]
    t, log = lin.found.regression.t, lin.found.regression.log

    law = term.law_of(BodyChange)
    weights = [np.asarray(law.weight(v, filled(t)))[: len(t)] * (log == v["log"]) for v in values]
    untold = [_untold(w, fold.train) for w, fold in zip(weights, lin.crossfit.folds, strict=True)]
    placed = replace(term, values={p.name: values[0][p.name] for p in term.law.nonlinear})
    within = tuple(w[:, None, None] * columns for w in weights)
    return Candidate(placed, within, seen.shape[2] + 2, apart=np.any(untold, axis=0))


def _untold(weight: np.ndarray, train: np.ndarray) -> np.ndarray:
    """Rows (T,) of held-out stretches in which a window begins or ends: a fit to the others cannot tell where.

    All places in such a stretch explain the same of the fitted rows; a load of 0.35 kg that was picked up at a
    stretch's end lost more by being carried too early there than it gained in all others. Nor is it not carried
    there: where it is for most of a stretch, that cost another more than ten others gained.
    """
    stretch = np.cumsum(np.diff(train, prepend=train[:1]))
    after = 1 + np.flatnonzero(np.diff(weight))
    edges = np.concatenate([after - 1, after])
    return ~train & np.isin(stretch, stretch[edges])


def _best_window(
    lin: Linearization, fold: Fold, seen: np.ndarray, logs: Sequence[int]
) -> dict | None:
    """Start, end and log of the window that explains most of a fold's rows of some logs; None if none does."""
    regression = lin.found.regression
    x = np.where(fold.train[:, None, None], seen, 0.0)
    best, found = 0.0, None
    for number in logs:
        rows = np.flatnonzero(regression.log == number)
        own = slice(rows[0], rows[-1] + 1)
        part = x[own], fold.residual[own], fold.basis[own]
        count = len(rows)
        edges = np.linspace(0, count, _EDGES + 1).astype(int)
        gain, pick = _look(part, edges, edges)
        width = count // _EDGES + 1
        starts, ends = (
            np.unique(np.clip(np.linspace(p - width, p + width, _FINE).astype(int), 0, count))
            for p in pick
        )
        again, closer = _look(part, starts, ends)
        gain, pick = (again, closer) if again > gain else (gain, pick)
        if gain > best:
            t = regression.t[rows]
            end = np.inf if pick[1] == count else float(t[pick[1]])
            best, found = gain, {"start": float(t[pick[0]]), "end": end, "log": float(number)}
    return found


def _look(
    part: tuple[np.ndarray, np.ndarray, np.ndarray], starts: np.ndarray, ends: np.ndarray
) -> tuple[float, tuple]:
    """The largest gain of the windows between row numbers of a log, and its first and last row.

    ``part``: The columns (T, n, d), the residual (T, n) and the basis (T, n, b) on the log's rows.
    """
    count = len(part[0])
    least = int(_LEAST * count)
    a, b = (x.ravel() for x in np.meshgrid(starts, ends, indexing="ij"))
    fits = (a > 0) & (b - a >= least) & (count - (b - a) >= least)
    if not fits.any():
        return 0.0, (0, count)
    a, b = a[fits], b[fits]
    edges = np.unique([*a, *b])
    first, last = np.searchsorted(edges, a), np.searchsorted(edges, b)
    squares, inner, held = (x[last] - x[first] for x in _running(part, edges))
    gains = _explained(squares, inner, held)
    pick = int(np.argmax(gains))
    return float(gains[pick]), (int(a[pick]), int(b[pick]))


def _running(
    part: tuple[np.ndarray, np.ndarray, np.ndarray], edges: np.ndarray
) -> list[np.ndarray]:
    """Sums of X^T X, X^T r and Q^T X from the first of some row numbers up to each of them, (E, ...) each."""
    columns, residual, basis = part
    sums = []
    for begin, end in pairwise(edges):
        x, q = (y[begin:end].reshape(-1, y.shape[2]) for y in (columns, basis))
        sums.append((x.T @ x, x.T @ residual[begin:end].ravel(), q.T @ x))
    return [np.cumsum([0.0 * one[0], *one], axis=0) for one in zip(*sums, strict=True)]


def _explained(squares: np.ndarray, inner: np.ndarray, held: np.ndarray) -> np.ndarray:
    """h^T (G - P^T P)^-1 h for many G (m, d, d), h (m, d) and P (m, b, d).

    Sums of a window are differences of sums up to its ends: where no row of it is fitted, or the model holds
    all of it, rounding leaves anything there, zero and less. That explains nothing.
    """
    whole = np.trace(squares, axis1=1, axis2=2)
    ridge = _RIDGE * whole + np.finfo(float).eps * whole.max()
    size, directions = np.linalg.eigh(squares - np.swapaxes(held, 1, 2) @ held)
    along = np.einsum("mdk,md->mk", directions, inner)
    told = np.where(size > 0.0, size + ridge[:, None], np.inf)
    return (along**2 / told).sum(axis=1)
