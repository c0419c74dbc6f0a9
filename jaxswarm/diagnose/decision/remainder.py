"""What a model leaves, against the noise: how many times it, when, and at which frequencies."""

from dataclasses import dataclass

import numpy as np

from jaxswarm.diagnose.decision.rules import NEAR
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
    """

    joint: int
    over_noise: float
    windows: tuple[tuple[int, float, float], ...]
    band: tuple[float, float]

    @property
    def near(self) -> bool:
        """Whether it is near the noise."""
        return self.over_noise <= NEAR


def remainders(found: Estimate) -> tuple[Remainder, ...]:
    """What a model leaves on every joint of the logs it was fitted to; rows it does not use left out."""
    used = found.regression.used_rows
    left = np.where(used, found.fit.residual, 0.0)
    return tuple(
        Remainder(j, float(size), _windows(found, over), _band(found, own))
        for j, (size, over, own) in enumerate(
            zip(over_noise(found), (left / row_noise(found)).T, left.T, strict=True)
        )
    )


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
