"""Every few samples of a log: as many as a link behind its motor is tried on.

Candidates are told apart by a torque below its cutoff, after a lag that swings within milliseconds. A log at
1 kHz has four times the samples that takes, and every option costs as many steps.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import gcd

import numpy as np

from jaxswarm.identify.forward.columns import is_kept
from jaxswarm.identify.forward.sensitivity import Sensitivity
from jaxswarm.logs.filtering import Decimator
from jaxswarm.logs.motion import Motion

# Interval [s] of samples that lags are tried on, and the least of them in a period of the torque's cutoff.
_INTERVAL, _LEAST = 4e-3, 16.0


@dataclass(frozen=True)
class SparseDecimator(Decimator):
    """The rows of a decimator from every few samples of a signal that has nothing beyond their rate.

    Attributes:
        taps, factor: Of the decimator, by the samples of the whole log.
        every: Every how many-th of these is given, the first one too.

    >>> taps, x = np.hanning(83)[1:-1], np.sin(0.02 * np.arange(700.0))
    >>> low = Decimator(taps / taps.sum(), 14)
    >>> few = SparseDecimator(low.taps, 14, 4)
    >>> few.apply(x[::4]).shape == low.apply(x).shape, abs(few.apply(x[::4]) - low.apply(x)).max() < 1e-4
    (True, np.True_)
    """

    every: int = 1

    def given(self, rows: int) -> int:
        """How many samples make so many rows."""
        return ((rows - 1) * self.factor + len(self.taps) - 1) // self.every + 1

    def kept(self, length: int) -> np.ndarray:
        """The nearest of the given samples to each row."""
        last = (length - 1) * self.every - (len(self.taps) - self.every)
        rows = np.arange(0, max(0, last) // self.factor + 1)
        return (rows * self.factor + self.margin + self.every // 2) // self.every

    def blocks(self, length: int, samples: int) -> Iterator[slice]:
        """Stretches of about so many given samples, as of :class:`Decimator`."""
        rows, turns = len(self.kept(length)), self.every // gcd(self.every, self.factor)
        each = turns * max(1, (samples - self.given(1)) * self.every // (turns * self.factor))
        for first in range(0, rows, each):
            start = first * self.factor // self.every
            yield slice(start, start + self.given(min(each, rows - first)))

    def apply(self, x: np.ndarray) -> np.ndarray:
        """Filter and decimate every few samples along the first axis."""
        flat = np.asarray(x, dtype=float).reshape(len(x), -1)
        low = np.empty((len(self.kept(len(x))), flat.shape[1]))
        turns = self.every // gcd(self.every, self.factor)
        for turn in range(min(turns, len(low))):
            # Rows begin between given samples, in turns.
            begin = turn * self.factor
            first = -(-begin // self.every)
            taps = self.taps[first * self.every - begin :: self.every]
            spans = np.lib.stride_tricks.sliding_window_view(flat[first:], len(taps), axis=0)
            own = spans[:: turns * self.factor // self.every] @ (taps / taps.sum())
            low[turn::turns] = own[: len(low[turn::turns])]
        return low.reshape(-1, *np.shape(x)[1:])


def thinned(motion: Motion, sensed: Sensitivity) -> tuple[Motion, Sensitivity]:
    """A log and what its torque feels on as many samples as lags are tried on.

    Args:
        motion: The log.
        sensed: What its torque does when a joint moves otherwise; it keeps what is found here.
    """
    every = interval_of(motion)
    if every < 2:
        return motion, sensed
    if every not in sensed.thinner:
        less, _ = every_few(motion, every)
        own = sensed.averaged(less, every, lambda x: straight_between(x, every))
        sensed.thinner[every] = less, own
    return sensed.thinner[every]


def every_few(motion: Motion, every: int) -> tuple[Motion, slice]:
    """A log on every few samples, and which these are: all where so few were less than its rows."""
    low = motion.decimator
    if not 2 <= every <= low.factor:
        return motion, slice(None)
    few = SparseDecimator(low.taps, low.factor, every)
    rows = len(low.kept(len(motion.t)))
    part = slice(0, every * few.given(rows), every)
    q, dq, ddq = (x[part] for x in (motion.q, motion.dq, motion.ddq))
    return replace(motion, t=motion.t[part], q=q, dq=dq, ddq=ddq, tau=None, decimator=few), part


def interval_of(motion: Motion) -> int:
    """Samples of a log from one that lags are tried on to the next; 1: all are, if fewer could not be kept."""
    every = int(motion.rate * min(_INTERVAL, 1.0 / (_LEAST * motion.torque_cutoff)) + 0.01)
    fewer = 2 <= every <= motion.decimator.factor and is_kept(motion, every)
    return every if fewer else 1


def usual_inertia(sensed: Sensitivity, pi: np.ndarray) -> float:
    """Median size of a joint's own inertia along a log [kg m^2 or kg]; of a long one on few samples."""
    if not is_kept(sensed.motion):
        sensed = thinned(sensed.motion, sensed)[1]
    return float(np.median(np.abs(sensed.inertia(pi))))


def straight_between(x: np.ndarray, every: int) -> np.ndarray:
    """Every few samples of a signal (T, ...), each with what lies up to the next, the nearer the more.

    What would fold back onto slow changes is averaged away.

    >>> straight_between(np.arange(9.0), 2).round(3).tolist()
    [0.333, 2.0, 4.0, 6.0, 7.667]
    """
    count = -(-len(x) // every)
    total, weight = np.zeros((count, *x.shape[1:])), np.zeros(count)
    for k in range(1 - every, every):
        first = -(k // every) if k < 0 else 0
        own = x[first * every + k :: every]
        rows = slice(first, min(count, first + len(own)))
        total[rows] += (every - abs(k)) * own[: rows.stop - first]
        weight[rows] += every - abs(k)
    return total / weight.reshape(-1, *[1] * (x.ndim - 1))
