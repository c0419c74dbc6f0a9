r"""Torques at the limit of their channel or their drive: what was asked beyond it is not in the log.

A clipped signal stays at its extreme, and does so much more often than at the values next to it. A coarse one
that turns around there stays, too. What tells them apart is what the samples on either side lead to: across a
stretch of :math:`w` samples entered and left with slopes :math:`a` and :math:`b` a parabola rises by
:math:`w (a + b) / 8` beyond the limit, which at a crest that is merely rounded is a step or two.
"""

from math import erf

import numpy as np

from jaxswarm.logs.filtering import white_noise
from jaxswarm.logs.quality import longest_run, quantum
from jaxswarm.logs.runs import runs

# Share of the range within which values are the same, and width of the bins beside the limit.
_SAME, _BIN = 1e-9, 1e-3
# Samples that the longest stay at the limit has, and how many times more are there than in a bin beside it.
_LONGEST, _OFTEN = 5, 5
# Loss beyond the limit, in steps or deviations of the noise, and as a share of the range, from which on it is
# one: a rounded crest seems to lose two steps, three with noise, and a hundredth of the range bends no fit.
_STEPS, _RANGE = 5.0, 0.01
_LEAST_SAMPLES = 4  # that noise can be told from
# Noise below this part of a step may be that of rounding, and below this part of the range that of the format;
# how often a log by chance has a longer stay than noise is said to allow.
_ROUNDING, _NOISE_OF_RANGE, _CHANCE = 0.4, 1e-5, 1e-3


def clipped(values: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """Whether samples sit at the largest or smallest value and hide what was beyond.

    Args:
        values: Torque, shape (T,).
        moving: Whether the joint moves, shape (T,): one at rest may need the same torque all the time, which
            a channel reads as one number where its noise does not show.

    Returns:
        Shape (T,), of bool.

    >>> wave = np.sin(np.linspace(0.0, 20.0, 2000))
    >>> bool(clipped(np.clip(wave, -2.0, 0.8), np.full(2000, True)).sum() > 300)
    True
    >>> clipped(np.round(wave, 2), np.full(2000, True)).any()
    np.False_
    """
    found = np.zeros(len(values), dtype=bool)
    span = float(np.ptp(values))
    if span == 0.0 or len(values) < _LEAST_SAMPLES:
        return found
    ends = [signal >= signal.max() - _SAME * span for signal in (values, -values)]
    if max(map(longest_run, ends)) < _LONGEST:
        return found
    step = quantum(values[~(ends[0] | ends[1])])  # what repeats at a limit is no step
    noise = float(white_noise(values[:, None])[0])
    by_chance = _longest_by_chance(
        len(values), step, noise if noise > _NOISE_OF_RANGE * span else 0.0
    )
    least = max(_STEPS * max(step, noise), _RANGE * span)
    for signal, end in zip((values, -values), ends, strict=True):
        sure = longest_run(end) > by_chance
        at_top = end if sure else _moved(end, moving)
        stays = _stays(signal, at_top, max(step, _BIN * span))
        if stays and (sure or _lost(signal, at_top) > least):
            found |= at_top
    return found


def _longest_by_chance(count: int, step: float, noise: float) -> float:
    """Samples in a row that a channel of such steps and noise reads alike, of so many, but for rare chance."""
    if noise <= _ROUNDING * step or noise == 0.0:
        return np.inf
    alike = erf(step / (2.0 * np.sqrt(2.0) * noise))  # at most: a torque in the middle of a step
    return max(np.log(count / _CHANCE) / -np.log(max(alike, 1e-9)), _LONGEST)


def _moved(at_top: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """The stays at the top during most of which the joint moves: it may turn around in one."""
    kept = at_top.copy()
    for start, end in zip(*runs(at_top), strict=True):
        kept[start:end] = 2 * moving[start:end].sum() > end - start
    return kept


def _stays(signal: np.ndarray, at_top: np.ndarray, width: float) -> bool:
    """Whether a signal is at its top for long, and more often than in any of the bins below it."""
    if longest_run(at_top) < _LONGEST:
        return False
    top = signal.max()
    close = signal < signal[at_top].min()
    counts = [
        int(
            np.sum(close & (signal >= top - (k + 1.5) * width) & (signal < top - (k + 0.5) * width))
        )
        for k in range(3)
    ]
    near = int(np.sum(close & (signal >= top - 0.5 * width)))
    return int(np.sum(at_top)) > _OFTEN * max(*counts, near, 1)


def _lost(signal: np.ndarray, at_top: np.ndarray) -> float:
    """The most that a parabola through both sides of a stay at the top rises beyond it."""
    starts, ends = runs(at_top)
    width = ends - starts
    beside = np.maximum(width // 2, 1)
    before, after = starts - beside, ends - 1 + beside
    whole = (
        (width >= _LONGEST) & (before >= 0) & (after < len(signal))
    )  # not cut by an end of the log
    if not whole.any():
        return np.inf if (width >= _LONGEST).any() else 0.0
    starts, before, after, width, beside = (
        x[whole] for x in (starts, before, after, width, beside)
    )
    rise = 2.0 * signal[starts] - signal[before] - signal[after]
    return float(np.max(width * rise / beside / 8.0))
