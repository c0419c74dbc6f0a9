"""The clock of the weight, which a slower computer may tell the drives and they hold until it tells the next.

Sampled where such a turn begins, the weight alone is half of the turn early, on all joints alike. Taken for the
clock of all torque that moved a clean arm's by 8 ms of 20, which was true of the five joints that carry weight
and wrong of the one that carries none: it was left with 1.6 times its noise, and a coupling of the transmission
was told for it at p = 1e-15. With a clock of its own the weight said -8.0 to -9.7 ms on each of the five,
with 1.4 to 2.2 ms of doubt, and the rest of the torque -1.5 of 1.4.
"""

import numpy as np

from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.time_slopes import (
    CERTAIN_CLOCK,
    SMALL_STEP,
    Rows,
    asked_rows,
    told_time,
    weight_slopes,
)


def weight_step(found: Estimate) -> float:
    """Time [s] by which the weight is read after all other torque, beyond what is allowed for; zero: not told.

    It is told by several joints, each of which could be spared: what one alone says may be a law of its own.

    Args:
        found: A fit.
    """
    known, most = found.motions[0].weight_skew, min(m.interval for m in found.motions)
    rows = asked_rows(found)
    weight = weight_slopes(found)[rows.asked]
    step, doubt = _told(found, rows, weight[:, :, None])
    if abs(known + step) > most or abs(step) <= (SMALL_STEP if known else CERTAIN_CLOCK) * doubt:
        return 0.0
    if known or all(
        _is_told_without(found, rows, weight, j, step)
        for j in np.flatnonzero(weight.any(axis=0)).tolist()
    ):
        return step
    return 0.0


def _is_told_without(
    found: Estimate, rows: Rows, weight: np.ndarray, joint: int, step: float
) -> bool:
    """Whether the others say so, too, where the weight on one joint has a clock of its own."""
    own = np.arange(weight.shape[1]) == joint
    others, doubt = _told(found, rows, np.stack([weight * own, weight * ~own], axis=2))
    return others * step > 0 and abs(others) > CERTAIN_CLOCK * doubt


def _told(found: Estimate, rows: Rows, weight: np.ndarray) -> tuple[float, float]:
    """The time of the last of some columns of weight (T', n, k), beside that of all torque."""
    return told_time(found, rows, np.concatenate([rows.slope[:, :, None], weight], axis=2))
