"""What a model leaves, against the noise: how many times it, when, at which frequencies, whether it repeats."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jaxswarm.diagnose.decision.rules import NEAR
from jaxswarm.diagnose.folds.blocks import period_of_path
from jaxswarm.diagnose.folds.noise import row_noise
from jaxswarm.identify.estimation.estimate import Estimate

# Windows of time [s] in which the remainder is told, and how many at most.
_WINDOW, _MOST_WINDOWS = 0.5, 6
# Shares of the remainder's power at whose frequencies its band begins and ends.
_BAND = (0.1, 0.9)


@dataclass(frozen=True)
class Remainder:
    """What is left on one joint.

    Attributes:
        joint: Index.
        over_noise: RMS of what is left over the noise of its row, in the compared band.
        windows: Where it is beyond the noise: log, begin and end [s].
        band: Frequencies [Hz] between which four fifths of its power lie.
        again: Of a log whose motion goes the same path again, after which time [s], and the correlation of
            what is left with what is left then; None: no log does.
    """

    joint: int
    over_noise: float
    windows: tuple[tuple[int, float, float], ...]
    band: tuple[float, float]
    again: tuple[float, float] | None = None

    @property
    def near(self) -> bool:
        """Whether it is near the noise."""
        return self.over_noise <= NEAR


def remainders(found: Estimate) -> tuple[Remainder, ...]:
    """What a model leaves on every joint of the logs it was fitted to; rows it does not use left out."""
    used = found.regression.used_rows
    left = np.where(used, found.fit.residual, 0.0)
    again = _again(found, used, left)
    return tuple(
        Remainder(j, float(size), _windows(found, over), _band(found, own), alike)
        for j, (size, over, own, alike) in enumerate(
            zip(over_noise(found), (left / row_noise(found)).T, left.T, again, strict=True)
        )
    )


def _again(
    found: Estimate, used: np.ndarray, left: np.ndarray
) -> Sequence[tuple[float, float] | None]:
    """For each joint the period of the first log that has one, and how alike what is left (T, n) is then.

    A law of the motion comes back with it; a push, what drifts, and noise that lasts for seconds do not.
    """
    for log, motion in enumerate(found.motions):
        period = period_of_path(motion)
        if period is None:
            continue
        rows = found.regression.log == log
        both, own, shift = used[rows], left[rows], round(period / found.regression.step[log])
        pairs = both[shift:] & both[:-shift]
        one, two = (np.where(pairs, x, 0.0) for x in (own[shift:], own[:-shift]))
        size = np.sqrt((one**2).sum(axis=0) * (two**2).sum(axis=0))
        same = (one * two).sum(axis=0) / np.maximum(size, 1e-300)
        return [(period, float(x)) for x in same]
    return [None] * left.shape[1]


def over_noise(found: Estimate) -> np.ndarray:
    """RMS (n,) of what is left of every joint, over the noise of its row, in the rows in use."""
    return found.regression.rms(found.fit.residual / row_noise(found))


def _windows(found: Estimate, over: np.ndarray) -> tuple:
    """Stretches of time whose RMS is far from the noise, the largest first chosen, told in their order."""
    stretches = []
    for log in np.unique(found.regression.log):
        rows = found.regression.log == log
        t, x = found.regression.t[rows], over[rows]
        number = ((t - t[0]) / _WINDOW).astype(int)
        power = np.bincount(number, x**2) / np.maximum(np.bincount(number), 1)
        far = np.flatnonzero(power > NEAR**2)
        for part in np.split(far, np.flatnonzero(np.diff(far) > 1) + 1):
            if len(part):
                begin, end = t[0] + _WINDOW * part[0], t[0] + _WINDOW * (part[-1] + 1)
                told = (int(log), float(begin), float(min(end, t[-1])))
                stretches.append((float(power[part].sum()), told))
    kept = sorted(stretches, reverse=True)[:_MOST_WINDOWS]
    return tuple(sorted(told for _, told in kept))


def _band(found: Estimate, own: np.ndarray) -> tuple[float, float]:
    rows = found.regression.log == found.regression.log[0]
    left = own[rows] - own[rows].mean()
    frequency = np.fft.rfftfreq(len(left), found.regression.step[0])
    power = np.abs(np.fft.rfft(left)) ** 2
    # All but these two have a twin among the negative frequencies.
    power[1 : None if len(left) % 2 else -1] *= 2.0
    grown = np.cumsum(power)
    if grown[-1] <= 0.0:
        return (0.0, 0.0)
    low, high = (frequency[np.searchsorted(grown, share * grown[-1])] for share in _BAND)
    return float(low), float(high)
