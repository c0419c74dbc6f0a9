"""When samples were taken: at their stamps, or evenly, with stamps that were written late.

A controller samples by its own clock, and the computer that logs it stamps each sample when it arrives. Such
stamps jitter although the samples do not; taken at their word, they turn velocity into position noise.
Whether they do is in the data: of the two readings the one with the smoother motion is right.
"""

from dataclasses import replace

import numpy as np
import scipy

from jaxswarm.logs.cutoffs import find_cutoffs
from jaxswarm.logs.log import Log

# Stamps nearer to an even clock than this share of the interval are even.
_EVEN = 1e-3
# Even samples must lower the noise of the positions to this share of what it is at the stamps.
_SMOOTHER = 0.8


def even_clock(t: np.ndarray) -> np.ndarray | None:
    """The even clock (T,) that stamps jitter about, missing samples left out; None where there is none.

    >>> even_clock(np.array([0.0, 0.11, 0.2, 0.29, 0.5])).round(2)
    array([0. , 0.1, 0.2, 0.3, 0.5])
    """
    number = np.concatenate([[0.0], np.cumsum(np.rint(np.diff(t) / np.median(np.diff(t))))])
    if (np.diff(number) < 1).any():
        return None
    step, start = np.polyfit(number, t, 1)
    clock = start + step * number
    return clock if np.abs(t - clock).max() < 0.5 * step else None


def with_sample_times(log: Log) -> Log:
    """The log with the times at which its samples were taken; told in a note where they are not the stamps."""
    clock = even_clock(log.t)
    if clock is None or len(log.t) < 100:
        return log
    step = float(np.median(np.diff(clock)))
    if np.abs(log.t - clock).max() < _EVEN * step:
        return log
    grid = np.arange(clock[0], clock[-1], step)
    stamped, even = (
        find_cutoffs(scipy.interpolate.CubicSpline(t, log.q)(grid), 1.0 / step).noise
        for t in (log.t, clock)
    )
    moving = even > 0.0
    if not moving.any() or np.median(even[moving] / stamped[moving]) > _SMOOTHER:
        return log
    jitter = 1e3 * float(np.std(log.t - clock))
    note = (
        f"time stamps jitter by {jitter:.2g} ms about an even clock on which the motion is smoother: "
        "samples are taken to be even"
    )
    return replace(log, t=clock, notes=(*log.notes, note))
