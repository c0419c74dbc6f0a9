"""Torques of the surroundings as candidates: the window in which they explain most."""

from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.term import Term

# Lengths of the windows tried: from this many rows to a third of the log.
_SHORTEST, _LENGTHS = 3, 32
# Travel, in units of what a memory forgets over, after which a twentieth of its unknown begin is left.
_FORGOTTEN = 3.0


def external_candidate(lin: Linearization, term: Term) -> Candidate | None:
    """The window whose constant torques explain most, found on running sums of the residual."""
    regression = lin.found.regression
    residual = np.where(_remembers(lin), 0.0, lin.crossfit.whole.residual * lin.crossfit.timing)
    total = np.concatenate([np.zeros((1, residual.shape[1])), np.cumsum(residual, axis=0)])
    best, pick = 0.0, None
    for length in np.unique(np.geomspace(_SHORTEST, len(residual) // 3, _LENGTHS).astype(int)):
        change = total[length:] - total[:-length]
        gain = (change**2).sum(axis=1) / length
        if gain.max() > best:
            first = int(np.argmax(gain))
            if regression.log[first] == regression.log[first + length - 1]:
                best, pick = gain.max(), (first, first + length - 1)
    if pick is None:
        return None
    start, end = regression.t[pick[0]], regression.t[pick[1]]
    log = regression.log[pick[0]]

    values = {"start": float(start), "end": float(end), "log": float(log)}

    def build(k):
        weight = term.law.weight(values, lin.found.motions[k].t) * (k == log)
        return lin.reported(k, weight[:, None, None] * np.eye(residual.shape[1]))

    columns = lin.stack(build)
    return Candidate(replace(term, values=values), lin.on_all(columns), 2 + residual.shape[1])


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
