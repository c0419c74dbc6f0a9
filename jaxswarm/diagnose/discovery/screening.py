"""The first look at all programs: each at a few points of its constants, the best of them refined by swarms.

A program's own linear constant is eliminated, and its column freed of what the model absorbs, so that it is
credited only with what the model cannot do without it.
"""

from collections.abc import Sequence
from typing import NamedTuple

import jax
import numpy as np
import scipy

from jaxswarm.diagnose.discovery import on_device, on_host
from jaxswarm.diagnose.discovery.grammar import MOST_CONSTANTS
from jaxswarm.diagnose.discovery.moving_load import fitted_together, goes_by_load
from jaxswarm.diagnose.discovery.pieces import Piece
from jaxswarm.diagnose.discovery.problem import Joint, SearchRows
from jaxswarm.diagnose.folds.partial_out import Fold

# Points of the constants at which a program is looked at, by their number; and the half width of the cube in
# which the best point is refined.
_POINTS = {0: 1, 1: 12, 2: 36, 3: 64}
_CELL = {0: 0.0, 1: 0.1, 2: 0.2, 3: 0.3}
# Programs of every number of constants that are refined, and mechanisms that have a name beside them.
_KEPT, _KEPT_NAMED = 24, 6
# Programs by a load that are weighed by the load fitted with them, and steps of that fit.
_LOADED, _STEPS = 60, 5


class Trial(NamedTuple):
    """A program with values for its constants.

    Attributes:
        piece: The program.
        values: Of its constants.
        share: Share of the residual's square that it takes off, where it was fitted.
    """

    piece: Piece
    values: dict[str, float]
    share: float


def screen(problem: Joint, fold: Fold, pieces: Sequence[Piece], seed: int = 0) -> list[Trial]:
    """The best programs on the rows of a fold with refined constants, the best first."""
    searched = problem.rows_of(fold)
    _, points, shares = surveyed(problem, searched, pieces)
    fold = fold.trained_on(problem.rows)
    _weigh_loaded(problem, fold, pieces, points, shares)
    chosen: list[int] = []
    for count in _POINTS:
        own = [i for i, one in enumerate(pieces) if len(one.constants) == count]
        own.sort(key=lambda i: (-shares[i], len(pieces[i].program)))
        chosen += own[:_KEPT] + [i for i in own[_KEPT:] if pieces[i].named][:_KEPT_NAMED]
    group = [pieces[i] for i in chosen]
    cell = np.array([_CELL[len(one.constants)] for one in group], np.float32)[:, None]
    low = np.clip(points[chosen] - cell, 0.0, 1.0 - 2.0 * cell).astype(np.float32)
    width = np.broadcast_to(2.0 * cell, low.shape).astype(np.float32)
    found = _engine().refined(problem.names, searched, group, low, width, seed)
    places, shares = map(np.array, found)  # those of a device cannot be written to
    _weigh_loaded(problem, fold, group, places, shares)
    trials = [Trial(*one) for one in zip(group, map(values_at, group, places), shares, strict=True)]
    return sorted(trials, key=lambda one: -one.share)


def _weigh_loaded(
    problem: Joint, fold: Fold, pieces: Sequence[Piece], places: np.ndarray, shares: np.ndarray
) -> None:
    """Set places (m, M) and shares (m,) of the best programs by a load to those by the load fitted beside."""
    by_load = [i for i, one in enumerate(pieces) if goes_by_load(problem, [one.program])]
    for i in sorted(by_load, key=lambda i: -shares[i])[:_LOADED]:
        own, values = pieces[i].constants, values_at(pieces[i], places[i])
        told = fitted_together(problem, [pieces[i].program], own, values, fold, _STEPS)
        shares[i] = told.share if np.isfinite(told.share) else 0.0
        if shares[i] > 0.0:
            places[i, : len(own)] = [p.encode(told.values[p.name]) for p in own]


def surveyed(
    problem: Joint, searched: SearchRows, pieces: Sequence[Piece]
) -> tuple[dict[int, np.ndarray], np.ndarray, np.ndarray]:
    """Points looked at, by the number of constants, the best of every program (m, M), and its share there."""
    lattices = {count: _lattice(count) for count in _POINTS}
    return lattices, *_engine().survey(problem.names, searched, pieces, lattices)


def _engine():
    return on_host if jax.default_backend() == "cpu" else on_device


def values_at(piece: Piece, place: np.ndarray) -> dict[str, float]:
    """Constants of a program at a point of the unit cube, (M,)."""
    return {
        p.name: float(np.clip(p.decode(float(u)), p.lower, p.upper))
        for p, u in zip(piece.constants, place[: len(piece.constants)], strict=True)
    }


def _lattice(count: int) -> np.ndarray:
    """Points of the unit cube, (m, M); what a program does not have stays in the middle."""
    full = np.full((_POINTS[count], MOST_CONSTANTS), 0.5, np.float32)
    if count == 1:
        full[:, 0] = (np.arange(_POINTS[1]) + 0.5) / _POINTS[1]
    elif count:
        draws = scipy.stats.qmc.Halton(count, scramble=False)
        full[:, :count] = draws.random(_POINTS[count] + 1)[1:]
    return full
