r"""Gaps in the record that are short against the motion: bridged for the filters, and left out of all else.

Cut there, a log of slow motion falls into parts too short for its low-pass, which is as long as its motion is
slow. The positions put into a gap are the smoothest course that the samples on either side support: the
minimizer of :mod:`jaxswarm.logs.smoothing` with no weight on what is missing. They are there so that filters
can pass: rows that see more than a little of them are neither fitted nor scored.
"""

from dataclasses import replace

import numpy as np
import scipy

from jaxswarm.logs.filtering import Decimator
from jaxswarm.logs.log import Log
from jaxswarm.logs.runs import runs
from jaxswarm.logs.sampling import sampling
from jaxswarm.logs.smoothing import solve

# Across this time [s] a cubic carries the motion of an arm, whose band ends at a few Hz.
CARRIED = 0.1 * (1.0 + 1e-9)
# A gap is short against a motion up to this part of its mean period. With a dozen gaps cut into three logs
# of two simulators the accelerations in the rows that are kept were off by 0.1 to 0.9 % of their RMS on all 16
# joints, and torques by 0.2 %, whether the gaps were 0.02 or 0.3 of that period.
_SHORT = 0.25
# Cutoff of what is put into a gap before that of the motion is known, times the gap's length; the periods of
# the cutoff that are looked at on either side, and samples in a period: more cost the system its digits.
_CUTOFF, _SIDE, _SAMPLES = 2.0, 3.0, 16.0
# A joint moves if it goes through so many times the noise of its position.
_MOVES = 100.0
# Samples that it needs, and its highest cutoff, as a part of the rate: beyond, nothing is smoothed.
_LEAST, _HIGHEST = 8, 0.4
# Rows whose low-pass has this share of its weight in gaps are left out, as in what was measured above.
_SEEN = 0.1


def bridged_time(q: np.ndarray, dq: np.ndarray, ddq: np.ndarray, noise: np.ndarray | None) -> float:
    """Time without samples [s] up to which a log is not cut.

    The mean period of a motion is that of its velocity's power, by its acceleration's (S. Rice, Bell System
    Technical Journal 23 (1944)); that of the joint whose is shortest counts.

    Args:
        q, dq, ddq: A motion of the log, (T, n) each.
        noise: Standard deviation of the noise of its positions, (n,); None: unknown.

    >>> t = np.linspace(0, 4 * np.pi, 1000)[:, None]
    >>> round(bridged_time(np.sin(t), np.cos(t), -np.sin(t), None) / (2 * np.pi), 2)
    0.25
    """
    moves = np.ptp(q, axis=0) > (0.0 if noise is None else _MOVES * noise)
    if not moves.any():
        return CARRIED
    fastest = np.sqrt((ddq[:, moves] ** 2).sum(axis=0) / (dq[:, moves] ** 2).sum(axis=0)).max()
    return max(CARRIED, float(_SHORT * 2.0 * np.pi / fastest))


def lost_samples(log: Log, clock: np.ndarray) -> np.ndarray | None:
    """Whether a clock (T',) ticks within a gap of a log that no cubic carries, (T',); None: nowhere.

    >>> t = np.delete(np.arange(200), slice(90, 98)) * 0.02
    >>> lost = lost_samples(Log("demo", ("joint1",), t, np.sin(t)[:, None]), np.arange(200) * 0.02)
    >>> np.flatnonzero(lost).tolist()
    [90, 91, 92, 93, 94, 95, 96, 97]
    """
    lost = np.zeros(len(clock), dtype=bool)
    for gap in sampling(log.t, log.q).gaps:
        if gap.length > CARRIED:
            edge = 1e-6 * gap.length
            ends = np.searchsorted(clock, [gap.start + edge, gap.start + gap.length - edge])
            lost[slice(*ends)] = True
    return lost if lost.any() else None


def bridged(
    q: np.ndarray,
    dq: np.ndarray | None,
    lost: np.ndarray | None,
    rate: float,
    cutoff: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray | None]:
    """Uniformly sampled positions (T, n), and velocities of them, with what is lost put in smoothly.

    The velocities put in are those of the positions put in: where the two channels told two motions, their
    noise was found up to four times too large.

    Args:
        q, dq: The signals, (T, n) each; what stands where samples are lost is not looked at.
        lost: Whether a sample is lost, (T,); None: none is.
        rate: Sampling rate [Hz].
        cutoff: Of the motion [Hz], (n,), where it is known.

    >>> t = np.arange(0, 4, 0.02)
    >>> wave = np.sin(2 * np.pi * t)[:, None]
    >>> lost = (t > 1.5) & (t < 1.7)
    >>> filled, _ = bridged(np.where(lost[:, None], 0.0, wave), None, lost, 50.0)
    >>> bool(np.abs(filled - wave).max() < 1e-3)
    True
    """
    if lost is None:
        return q, dq
    q, dq = np.array(q, dtype=float), None if dq is None else np.array(dq, dtype=float)
    for begin, end in zip(*runs(lost), strict=True):
        usual = _CUTOFF * rate / (end - begin + 1)
        for j, own in enumerate([usual] * q.shape[1] if cutoff is None else cutoff):
            course = _course(q[:, j], lost, slice(begin, end), rate, own)
            if course is not None:
                inside = np.arange(begin, end)
                q[inside, j] = course(inside)
                if dq is not None:
                    dq[inside, j] = course.derivative()(inside) * rate
    return q, dq


def _course(
    x: np.ndarray, lost: np.ndarray, gap: slice, rate: float, cutoff: float
) -> scipy.interpolate.BSpline | None:
    """What goes into a gap of a signal (T,), by the samples beside it; None where these are too few."""
    stride = max(1, int(rate / (_SAMPLES * cutoff)))
    side = int(np.ceil(_SIDE * rate / (cutoff * stride)))
    # Counted from the last sample before the gap, so that it is among them.
    steps = -(-(gap.stop - gap.start + 1) // stride)
    near = gap.start - 1 + stride * np.arange(-side, steps + side + 1)
    near = near[(near >= 0) & (near < len(x))]
    known = ~lost[near]
    if known.sum() <= _LEAST or near[-1] < gap.stop:
        return None
    found = solve(x[near, None], None, rate / stride, min(cutoff, _HIGHEST * rate), 0.0, known)
    return scipy.interpolate.make_interp_spline(near, found.mean[:, 0], k=5)


def lost_rows(lost: np.ndarray | None, decimator: Decimator, length: int) -> np.ndarray:
    """The decimated rows (T',) of a log of so many samples that see too much of what is lost (T,)."""
    if lost is None:
        return np.zeros(len(decimator.kept(length)), dtype=bool)
    weight = np.abs(decimator.taps)
    seen = replace(decimator, taps=weight / weight.sum()).apply(lost.astype(float)[:, None])
    return seen[:, 0] > _SEEN
