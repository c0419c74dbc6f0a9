"""The clock of a log: its rate, its jitter, and where it stops or jumps.

A period of more than five usual ones is a gap, unless stamps come in bursts. If the joints moved
across it no further than in a few usual periods, nothing is missing and the clock itself jumped.
"""

from dataclasses import dataclass

import numpy as np

_GAP_PERIODS = 5.0
# Stamps come in bursts where most follow another within a millisecond, but so many do not that they
# cannot be pauses. Three of the longest common periods are a gap then.
_BURST_PERIOD = 1e-3
_COMMON, _COMMON_PERIODS = 0.98, 3.0
# Motion across a gap, in steps of its neighborhood, up to which the samples follow on each other.
_ADJACENT_STEPS = 3.0


@dataclass(frozen=True)
class Gap:
    """A place where time passes without samples.

    Attributes:
        sample: Index (from 0) of the last sample before it.
        start: Time of that sample [s].
        length: Time without samples [s].
        clock_jump: Whether the motion goes on as if no time had passed.
    """

    sample: int
    start: float
    length: float
    clock_jump: bool


@dataclass(frozen=True)
class Sampling:
    """The clock of a log.

    Attributes:
        rate: Samples per second of recorded time [Hz].
        shortest, longest: Shortest and longest period that is no gap [s].
        jitter: Standard deviation of the periods that are no gaps, as a share of their mean.
        gaps: Where samples are missing or the clock jumped.
    """

    rate: float
    shortest: float
    longest: float
    jitter: float
    gaps: tuple[Gap, ...]


def usual_period(time: np.ndarray) -> float:
    """The period of a clock [s]: the median, or the mean where the stamps come in bursts.

    Half the stamps of a log may follow others by microseconds, while the samples were taken regularly:
    the median is then no period of anything. The longest periods, which may be gaps, do not count.

    Args:
        time: Time stamps [s], shape (T,), increasing, T > 1.

    >>> bursts = (np.arange(100)[:, None] * 0.01 + np.arange(5) * 1e-6).ravel()
    >>> round(usual_period(np.arange(100) * 0.01), 6), 0.001 < usual_period(bursts) < 0.003
    (0.01, True)
    """
    period = np.diff(time)
    return _common_mean(period) if _in_bursts(period) else float(np.median(period))


def _common_mean(period: np.ndarray) -> float:
    return float(np.mean(period[period <= np.quantile(period, _COMMON)]))


def _in_bursts(period: np.ndarray) -> bool:
    median = float(np.median(period))
    return median < _BURST_PERIOD and median < 0.5 * _common_mean(period)


def sampling(time: np.ndarray, q: np.ndarray) -> Sampling:
    """Describe the clock of a log.

    Args:
        time: Time stamps [s], shape (T,), strictly increasing.
        q: Positions, shape (T, n).

    >>> t = np.concatenate([np.arange(50), np.arange(70, 120)]) * 0.01
    >>> found = sampling(t, np.sin(t)[:, None])
    >>> round(found.rate), found.gaps[0].sample, found.gaps[0].clock_jump
    (100, 49, False)
    """
    period = np.diff(time)
    usual = usual_period(time)
    bursts = _COMMON_PERIODS * float(np.quantile(period, _COMMON)) if _in_bursts(period) else 0.0
    long = period > max(_GAP_PERIODS * usual, bursts)
    kept = period[~long]
    mean = float(np.mean(kept))
    gaps = tuple(
        Gap(int(i), float(time[i]), float(period[i]), _motion_goes_on(q, int(i), long))
        for i in np.flatnonzero(long)
    )
    return Sampling(
        1.0 / mean, float(kept.min()), float(kept.max()), float(np.std(kept)) / mean, gaps
    )


def _motion_goes_on(q: np.ndarray, gap: int, long: np.ndarray) -> bool:
    """Whether a moving robot's step across a gap has the size of the steps around it."""
    around = [i for i in range(max(0, gap - 5), min(len(q) - 1, gap + 6)) if not long[i]]
    if len(around) < 4:
        return False
    moves = np.diff(q, axis=0)[around]
    steps = np.abs(moves)
    usual = np.median(steps, axis=0)
    # A joint in steady motion moves in every period; joints at rest tell nothing.
    steady = (steps.min(axis=0) > 0.2 * usual) & (usual > 0)
    # One that came back the other way took its time to turn.
    signs = np.sign(moves[:, steady])
    if not steady.any() or (signs != signs[0]).any():
        return False
    across = np.abs(q[gap + 1] - q[gap])
    return bool(np.all(across[steady] <= _ADJACENT_STEPS * usual[steady]))
