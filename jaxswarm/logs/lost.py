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
# Rows whose windows stand in memory at a time.
_ROWS = 50_000
# Share of the steps that tell: fewer are jitter; and so many more doubled than repeated ones.
_LEAST_SHARE, _MORE = 0.03, 4.0
# Steps tell where the usual step is this many times the noise of a step; so many have to.
_CLEAR, _LEAST_STEPS = 8.0, 100


def lost_samples(log: Log) -> list[Finding]:
    """Whether the motion jumps by whole samples at steady time, in all joints at once."""
    if len(log.t) < _LEAST_STEPS:
        return []
    speed = np.diff(log.q, axis=0) / np.diff(log.t)[:, None]
    noise = np.median(np.abs(np.diff(speed, axis=0)), axis=0) / 0.6745 / np.sqrt(2.0)
    noise = np.maximum(noise, 1e-3 * np.abs(speed).max(axis=0)) + 1e-300
    scaled = speed / noise
    windows = np.lib.stride_tricks.sliding_window_view(scaled, 2 * _SIDE + 1, axis=0)
    size, along = np.empty((2, len(windows)))
    for start in range(0, len(windows), _ROWS):  # a median copies all its windows
        rows = slice(start, start + _ROWS)
        usual = np.median(windows[rows], axis=2)
        size[rows] = (usual**2).sum(axis=1)
        along[rows] = (windows[rows, :, _SIDE] * usual).sum(axis=1)
    clear = size > _CLEAR**2
    if clear.sum() < _LEAST_STEPS:
        return []
    factor = along[clear] / size[clear]
    doubled, repeated = np.mean(factor > _DOUBLE), np.mean(factor < _REPEATED)
    if doubled < _LEAST_SHARE or doubled < _MORE * repeated:
        return []
    what = (
        f"in {100 * doubled:.0f} % of the steps all joints move as far as in two or more: samples are "
        "missing while t goes on evenly"
    )
    return [
        Finding(NAME, what, "Log without loss, or with the time at which each sample was taken")
    ]
