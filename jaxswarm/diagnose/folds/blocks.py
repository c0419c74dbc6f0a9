"""The blocks of rows by which evidence is counted."""

import numpy as np

from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.validate import time_blocks
from jaxswarm.logs.coverage import repeats_after
from jaxswarm.logs.motion import Motion

# Blocks per log, and the least number of rows in one.
_BLOCKS, _LEAST_ROWS = 20, 8
# Phases of a motion that repeats itself: fewer prove nothing, and time is held out.
_LEAST_PHASES = 6
# Paths are the same to this part of their size: tracked references are to 0.01, sums of tones that nearly fit a
# period to 0.1.
_SAME_PATH = 0.03


def blocks_of(found: Estimate) -> np.ndarray:
    """Number the rows (T,) by blocks: stretches of time, or of the phase of a motion that repeats itself.

    What repeats with the motion, as the errors of its sampling do, is in every period alike: time that is
    held out of such a log repeats time that was fitted, phases that are held out do not.
    """
    log, t = found.regression.log, found.regression.t
    per_log = max(4, min(_BLOCKS, int(np.bincount(log).min()) // _LEAST_ROWS))
    block = time_blocks(log, per_log)
    for k, motion in enumerate(found.motions):
        period = period_of_path(motion)
        rows = log == k
        if period is None or not rows.any():
            continue
        step = found.regression.step[k]
        count = min(per_log, int(period / step) // _LEAST_ROWS)
        if count >= _LEAST_PHASES:
            phase = (t[rows] - t[rows][0]) / period % 1.0
            block[rows] = k * per_log + (phase * count).astype(int)
    return np.unique(block, return_inverse=True)[1]


def period_of_path(motion: Motion) -> float | None:
    """Time [s] after which a log goes the same path again, not only one much like it; None if it does not."""
    period = repeats_after(motion.t, motion.q)
    if period is None:
        return None
    again = round(period * motion.rate)
    apart = np.sqrt(((motion.q[again:] - motion.q[:-again]) ** 2).mean(axis=0))
    return period if (apart <= _SAME_PATH * motion.q.std(axis=0)).all() else None
