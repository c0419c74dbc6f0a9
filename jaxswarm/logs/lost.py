"""Samples that are missing while the time stamps go on as if they were not."""

import numpy as np

from jaxswarm.logs.finding import Finding
from jaxswarm.logs.log import Log

NAME = "lost_samples"
# A step of so many steps of its neighborhood has a sample missing in it, and one below the other number is
# a repeated sample, as in logs that are faster than their source.
_DOUBLE, _REPEATED = 1.6, 0.4
# Neighbors on either side whose median step is the usual one.
_SIDE = 4
# Rows that stand in memory at a time, with their windows.
_ROWS = 50_000
# Share of the steps that tell: fewer are jitter; and so many more doubled than repeated ones.
_LEAST_SHARE, _MORE = 0.03, 4.0
# Steps tell where the usual step is this many times the noise of a step; so many have to.
_CLEAR, _LEAST_STEPS = 8.0, 100


def _noise(speed: np.ndarray) -> float:
    """Noise of a joint's steps (T,), at least what a thousandth of its top speed is."""
    white = np.median(np.abs(np.diff(speed))) / 0.6745 / np.sqrt(2.0)
    return max(white, 1e-3 * np.abs(speed).max()) + 1e-300


def lost_samples(log: Log) -> list[Finding]:
    """Whether the motion jumps by whole samples at steady time, in all joints at once."""
    if len(log.t) < _LEAST_STEPS:
        return []
    step = np.diff(log.t)
    noise = np.array([_noise(np.diff(q) / step) for q in log.q.T])
    width = 2 * _SIDE + 1
    size, along = np.empty((2, len(log.t) - width))
    for start in range(0, len(size), _ROWS):  # a median copies all its windows
        rows, part = slice(start, start + _ROWS), slice(start, start + _ROWS + width)
        scaled = np.diff(log.q[part], axis=0) / np.diff(log.t[part])[:, None] / noise
        windows = np.lib.stride_tricks.sliding_window_view(scaled, width, axis=0)
        usual = np.median(windows, axis=2)
        size[rows] = (usual**2).sum(axis=1)
        along[rows] = (windows[:, :, _SIDE] * usual).sum(axis=1)
    clear = size > _CLEAR**2
    if clear.sum() < _LEAST_STEPS:
        return []
    factor = along[clear] / size[clear]
    # Stamps that jitter about even samples halve steps of time, and with it double speeds, not distances.
    far = factor * np.minimum(step[_SIDE:-_SIDE][clear] / np.median(step), 1.0)
    doubled, repeated = np.mean(far > _DOUBLE), np.mean(factor < _REPEATED)
    if doubled < _LEAST_SHARE or doubled < _MORE * repeated:
        return []
    what = (
        f"in {100 * doubled:.0f} % of the steps all joints move as far as in two or more: samples are "
        "missing while t goes on evenly"
    )
    return [
        Finding(NAME, what, "Log without loss, or with the time at which each sample was taken")
    ]
