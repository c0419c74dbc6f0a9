"""Torques of the surroundings as candidates: the window in which they explain most."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.written_down import clock_lag

# Lengths of the windows tried: from this many rows to a third of the log.
_SHORTEST, _LENGTHS = 3, 32
# Places of a begin and an end that are tried at once around those of the best.
_FINE = 64
# A window that holds less than this part of a joint's squared weights says nothing of it.
_NOTHING = 1e-6
# Travel, in units of what a memory forgets over, after which a twentieth of its unknown begin is left.
_FORGOTTEN = 3.0


def external_candidate(lin: Linearization, term: Term) -> Candidate | None:
    """The window whose constant torques explain most, found on running sums of the residual.

    Rows that do not count say nothing against a window: one of 2 s was told as two, as its joint rested within.
    """
    regression, folds = lin.found.regression, lin.crossfit
    counts = np.where(_remembers(lin), 0.0, folds.timing)
    push, left = folds.weight * counts, folds.whole.residual * counts
    gain = _gain_of(push, left)
    pick = _best(gain, regression.log)
    if pick is None:
        return None
    log = regression.log[pick[0]]
    pick = _closer(gain, pick, np.flatnonzero(regression.log == log)[[0, -1]] + [0, 1])
    # It begins between the last row without it and the first one with it; the arm felt it before a late clock.
    half, t = 0.5 * regression.step[int(log)], regression.t - clock_lag(lin.found.model.terms)
    start, end = t[pick[0]] - half, t[pick[1] - 1] + half

    values = {"start": max(float(start), 0.0), "end": float(end), "log": float(log)}

    def build(k):
        weight = term.law.weight(values, lin.found.motions[k].t) * (k == log)
        return lin.reported(k, weight[:, None, None] * np.eye(push.shape[1]))

    columns = lin.stack(build)
    return Candidate(replace(term, values=values), lin.on_all(columns), 2 + push.shape[1])


def loudest(
    push: np.ndarray, left: np.ndarray, log: np.ndarray, most: int, stands_out: Callable[..., bool]
) -> np.ndarray:
    """The rows (T,) of the windows that explain most one after the other, if they stand out.

    Args:
        push: Columns of a constant torque on every joint, (T, n), in units of the noise.
        left: The residual, (T, n), in the same.
        log: The log of every row.
        most: So many windows.
        stands_out: ``stands_out(share, time)``: whether the share that is explained of the squares is much for
            this share of the rows, of a window beside those before it or of all of them together.
    """
    rows, told, explained, each = np.zeros(len(left), bool), np.zeros(len(left), bool), 0.0, True
    whole = max(float((left**2).sum()), 1e-300)
    for _ in range(most):
        keep = ~rows[:, None]
        gain = _gain_of(push * keep, left * keep)
        pick = _best(gain, log)
        if pick is None:
            break
        more = float(gain(*np.array(pick)[:, None])[0])
        each = each and stands_out(more / (whole - explained), (pick[1] - pick[0]) / keep.sum())
        rows[slice(*pick)] = True
        explained += more
        if each or stands_out(explained / whole, rows.mean()):
            told = rows.copy()
    return told


def _gain_of(push: np.ndarray, left: np.ndarray) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """What windows from one row up to another one explain of a residual, as a function of both."""
    total, size = (
        np.concatenate([np.zeros((1, push.shape[1])), np.cumsum(x, axis=0)])
        for x in (push * left, push**2)
    )
    least = np.maximum(_NOTHING * size[-1], 1e-300)

    def gain(first: np.ndarray, after: np.ndarray) -> np.ndarray:
        said, known = (x[after] - x[first] for x in (total, size))
        return (said**2 / np.maximum(known, least)).sum(axis=1)

    return gain


def _best(
    gain: Callable[[np.ndarray, np.ndarray], np.ndarray], log: np.ndarray
) -> tuple[int, int] | None:
    """The first row and the one after the last of the best window of the lengths tried; None if none gains."""
    best, pick = 0.0, None
    for length in np.unique(np.geomspace(_SHORTEST, len(log) // 3, _LENGTHS).astype(int)):
        first = np.arange(len(log) + 1 - length)
        first = first[log[first] == log[first + length - 1]]
        gains = gain(first, first + length)
        if len(first) and gains.max() > best:
            best, begin = gains.max(), int(first[np.argmax(gains)])
            pick = begin, begin + length
    return pick


def _closer(
    gain: Callable[[np.ndarray, np.ndarray], np.ndarray], pick: tuple[int, int], ends: np.ndarray
) -> tuple[int, int]:
    """The best window whose begin and end lie near those of one, to the row, in a log between two row numbers.

    Lengths were tried a tenth apart: a push of 2 s was told 0.1 s too long at either end, ten times its doubt.
    """
    reach = max(_SHORTEST, (pick[1] - pick[0]) // 3)
    while True:
        step = max(1, 2 * reach // _FINE)
        near = [np.arange(p - reach, p + reach + 1, step) for p in pick]
        first, after = (x.ravel() for x in np.meshgrid(*near, indexing="ij"))
        fits = (first >= ends[0]) & (after <= ends[1]) & (after - first >= _SHORTEST)
        first, after = first[fits], after[fits]
        found = gain(first, after)
        # Of windows that say the same, as where rows do not count, the shortest.
        same = np.flatnonzero(found >= (1.0 - 1e-9) * found.max())
        one = same[np.argmin((after - first)[same])]
        pick = int(first[one]), int(after[one])
        if step == 1:
            return pick
        reach = step


def _remembers(lin: Linearization) -> np.ndarray:
    """Where a joint's friction still goes by what was before the log, (T, n): no contact shows there.

    How far bristles are bent when a log begins nobody knows; what the model leaves of it decays over their
    first bend, and looked like a push on two worlds.
    """
    regression = lin.found.regression
    rows = np.zeros(regression.torque.shape, bool)
    for k, motion in enumerate(lin.found.motions):
        kept = motion.decimator.kept(len(motion.t))
        for term in lin.found.model.during(k).terms:
            if isinstance(term.law, TorqueLaw) and term.law.forgets:
                way = np.abs(motion.dq[:, term.joint]) * motion.interval
                travel = np.cumsum(way)[kept]
                rows[regression.log == k, term.joint] |= (
                    travel < _FORGOTTEN * term.values[term.law.forgets]
                )
    return rows
