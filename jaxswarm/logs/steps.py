"""What sampling leaves unknown where a torque jumps between two samples.

A drive that is given a step of acceleration answers with a step of torque, at any time between the sample
before it and the sample after: its torque, low-passed, is known to the area of that step times a time that is
uniform over one sampling interval, :math:`\\sigma^2 = \\Delta^2 h^2 / 12` with the low-pass's impulse response
:math:`h`. On a clean world, steps of 60 N m left six times the noise for two rows, and were told as a contact.
"""

import numpy as np
import scipy

from jaxswarm.logs.filtering import Decimator, white_noise

# A change between samples, beyond what its neighbors change by, is a jump from this many times the
# sample-to-sample noise on: noise alone makes it 2.2 times that noise, so that one of 10 million is beyond.
_JUMP = 12.0
_SPREAD = 3


def step_noise(
    torque: np.ndarray, interval: float, decimator: Decimator, lasting: int
) -> np.ndarray:
    """Standard deviation of decimated torques (T', n) from when in its interval a jump was.

    Args:
        torque: What is left of it on the working clock, (T, n) [N m or N].
        interval: Of the log's samples, in those of the working clock.
        decimator: The low-pass of the working clock.
        lasting: Samples over which what remains after a jump is no matter of when it was: a push lasts,
            what smoothing leaves at a step does not.

    >>> step = np.repeat([[0.0], [10.0]], 50, axis=0)
    >>> step_noise(step, 1.0, Decimator(np.ones(5) / 5, 1), 0).max().round(3)  # 10 / 5 / sqrt(12)
    np.float64(0.577)
    """
    # The low-pass before thinning spreads a jump over three samples.
    lag = 1 if interval > 0.999 else _SPREAD
    if len(torque) <= 3 * lag:
        return decimator.apply(np.zeros_like(torque))
    change = torque[lag:] - torque[:-lag]
    around = np.empty_like(change)
    around[lag:-lag] = 0.5 * (change[: -2 * lag] + change[2 * lag :])
    around[:lag], around[-lag:] = change[lag : 2 * lag], change[-2 * lag : -lag]
    # The change's own part alone: a lone jump is half of what its neighbors seem to jump by.
    size = np.abs(change)
    lone = (size > np.abs(around)) & (size >= scipy.ndimage.maximum_filter1d(size, lag, axis=0))
    jump = np.where(lone, change - around, 0.0)
    jump = np.sign(jump) * np.maximum(np.abs(jump) - _level(torque, lag, lasting, jump), 0.0)
    jump[np.abs(jump) <= _JUMP * white_noise(torque)] = 0.0
    power = np.zeros_like(torque)
    power[lag // 2 : lag // 2 + len(jump)] = jump**2
    squared = Decimator(decimator.taps**2, decimator.factor)
    return interval * np.sqrt(squared.apply(power) / 12.0)


def _level(torque: np.ndarray, lag: int, lasting: int, jump: np.ndarray) -> np.ndarray:
    """How much of jumps (T - lag, n) the mean torque after them keeps over that before."""
    if lasting == 0:
        return np.zeros_like(jump)
    total = np.concatenate([np.zeros((1, torque.shape[1])), np.cumsum(torque, axis=0)])
    first = np.arange(len(jump))
    begin, end = np.maximum(first + 1 - lasting, 0), np.minimum(first + lag + lasting, len(torque))
    before = (total[first + 1] - total[begin]) / (first + 1 - begin)[:, None]
    after = (total[end] - total[first + lag]) / (end - first - lag)[:, None]
    return np.maximum((after - before) * np.sign(jump), 0.0)
