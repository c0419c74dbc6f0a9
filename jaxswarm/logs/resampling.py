"""A log on a uniform clock, and every how many-th of its samples a model needs."""

import numpy as np
import scipy

from jaxswarm.errors import InputError
from jaxswarm.logs.butterworth import butterworth
from jaxswarm.logs.clock import with_sample_times
from jaxswarm.logs.log import Log
from jaxswarm.logs.sampling import usual_period

# Working rate per band of the motion: friction jumps where a joint reverses, and a jump between samples
# folds back into the band, which moves the sign's width and every delay.
_RATE = 16.0
# Samples that a spline of fifth order needs.
_LEAST_SAMPLES = 20
# Samples that the smoothing of a motion needs at the working rate.
_LEAST_WORKING = 10
# The low-pass before thinning looks three filter lengths beyond either end.
_LEAST_THINNED = 28
# Samples are missing between two that are so many intervals apart: jitter alone leaves none out.
_MISSING = 2.5


class TooShort(InputError):
    """A log, or a stretch of one, with too few samples to filter."""


def uniform_clock(log: Log) -> tuple[Log, np.ndarray, float]:
    """The log at the times of its samples, a uniform clock over it, and its usual rate [Hz].

    Raises:
        TooShort: If there are too few samples to differentiate.
    """
    if len(log.t) < _LEAST_SAMPLES:
        raise TooShort(
            f"{log.source}: {len(log.t)} samples are too few to differentiate; log at least "
            f"{_LEAST_SAMPLES}"
        )
    log = with_sample_times(log)
    step = usual_period(log.t)
    count = int(round((log.t[-1] - log.t[0]) / step)) + 1
    rate = (count - 1) / (log.t[-1] - log.t[0])
    return log, log.t[0] + np.arange(count) / rate, rate


def bridged_samples(t: np.ndarray, clock: np.ndarray, interval: float) -> np.ndarray | None:
    """Whether a clock (T',) ticks where samples at times (T,) are missing, (T',); None where none are.

    >>> bridged_samples(np.array([0.0, 1.0, 2.0, 6.0, 7.0]), np.arange(8.0), 1.0).astype(int)
    array([0, 0, 0, 1, 1, 1, 0, 0])
    """
    missing = np.flatnonzero(np.diff(t) > _MISSING * interval)
    if not len(missing):
        return None
    before = np.searchsorted(clock, t[missing] + 0.5 * interval)
    after = np.searchsorted(clock, t[missing + 1] - 0.5 * interval)
    bridged = np.zeros(len(clock) + 1, int)
    np.add.at(bridged, before, 1)
    np.add.at(bridged, after, -1)
    return np.cumsum(bridged[:-1]) > 0


def resample(t: np.ndarray, x: np.ndarray, clock: np.ndarray, cubic: bool) -> np.ndarray:
    """Values (T, n) of times (T,) on a clock (T',), by a cubic spline or by straight lines."""
    if len(t) == len(clock) and np.abs(t - clock).max() < 1e-3 * (clock[1] - clock[0]):
        return np.asarray(x, dtype=float)
    flat, smooth = x.reshape(len(x), -1), cubic and np.isfinite(x).all()
    clock = clock if smooth else np.clip(clock, t[0], t[-1])
    through = scipy.interpolate.CubicSpline if smooth else scipy.interpolate.interp1d
    values = np.empty((len(clock), flat.shape[1]))
    for k, column in enumerate(flat.T):  # one at a time: a spline takes four numbers a sample
        values[:, k] = through(t, column)(clock)
    return values.reshape(-1, *np.shape(x)[1:])


def earlier(t: np.ndarray, x: np.ndarray, seconds: float) -> np.ndarray:
    """What was known at times (T,) [s], shape (T, ...), as it was ``seconds`` earlier."""
    return scipy.interpolate.CubicSpline(t, x, axis=0)(t - seconds) if seconds else x


def thin(x: np.ndarray, rate: float, stride: int) -> np.ndarray:
    """Keep every ``stride``-th sample, after a low-pass that removes what would fold back."""
    if stride == 1:
        return np.asarray(x, dtype=float)
    flat = np.asarray(x, dtype=float).reshape(len(x), -1)
    # A column at a time: of a long log only what is kept of them stands in memory together.
    low = np.empty((-(-len(flat) // stride), flat.shape[1]))
    for k, column in enumerate(flat.T):
        low[:, k] = butterworth(column, rate, 0.4 * rate / stride, 6)[::stride]
    return low.reshape(-1, *np.shape(x)[1:])


def stride_for(log: Log, samples: int, rate: float, highest: float) -> int:
    """Every how many-th sample is enough for motion below a frequency [Hz].

    Raises:
        TooShort: If too few of them are left.
    """
    stride = max(1, int(rate / (_RATE * highest)))
    thinned_away = stride > 1 and samples < _LEAST_THINNED
    if thinned_away or -(-samples // stride) < _LEAST_WORKING:
        least = max(_LEAST_THINNED, _LEAST_WORKING * stride) / rate
        raise TooShort(
            f"{log.source}: {log.t[-1] - log.t[0]:.3g} s are too short for motion below "
            f"{highest:.3g} Hz; log at least {least:.2g} s, or raise --motion-cutoff"
        )
    return stride
