"""Noise of what is sharper than any smoothing or sampling shows, read off above the compared band.

The noise of positions has more power the higher the frequency, and is drawn by itself; the torque's sensor
has its own. Sharp is what a window of time has clearly more of than both. With all above the band told as
sharp, a bristle of six times the noise was not seen, and 62 of 157 joints of 31 clean logs of other simulators
were left with less than 0.7 times their noise; 44 are now.
"""

from collections.abc import Sequence

import numpy as np
import scipy

from jaxswarm.logs.butterworth import butterworth
from jaxswarm.logs.motion import Motion

# Order of the filters.
_ORDER = 4
# Where the octave begins and ends that tells what is sharp, over the torque's cutoff; and the time [s] over
# which its power is averaged, in any case a period of the cutoff.
_ABOVE, _WINDOW = (1.5, 3.0), 0.25
# Where the upper half of the band begins, over that cutoff; the order of the filter that parts it from what is
# above it, and the degrees of freedom of its power where that is compared.
_INSIDE, _STEEP, _FREEDOM = 0.5, 8, 10.0
# Chance with which noise alone is told as sharp in a window.
_CHANCE = 0.01
# Without this share of the working rate above the band, it tells nothing.
_LEAST_SHARE = 0.05


def sharp_noise(motion: Motion, left: np.ndarray, drawn: list[np.ndarray]) -> np.ndarray:
    """Standard deviation (T', n) below the torque cutoff of what is sharp, beyond the noise of the sensors.

    Args:
        motion: Whose noise it is.
        left: What a model leaves of it on its working clock, (T, n).
        drawn: What draws of the noise of its positions make of the model's torque, each (T, n).

    It has as much power per hertz in the octave just above the band as above that. A drive that jitters only
    there, at all times, was told as 12 times what a clean log is left with. And it has as much in the upper
    half of the band itself: a drive that rang at 2.2 times the cutoff while its joint moved left a tenth of
    that there, and friction that fell by 30 times the sensor's noise was "nothing missing" beside it.
    """
    rate, (begin, end) = motion.rate, np.multiply(_ABOVE, motion.torque_cutoff)
    if 0.5 * rate - begin < _LEAST_SHARE * rate:
        return np.zeros((len(motion.decimator.kept(len(motion.t))), motion.q.shape[1]))
    sensor = np.zeros(motion.q.shape[1]) if motion.torque_noise is None else motion.torque_noise
    bands = [(begin, 0.5 * rate), (begin, end)][: 1 + (end < 0.5 * rate)]
    known = [np.zeros_like(sensor)] * len(bands)
    if drawn:
        known = list(np.mean([_powers(motion, x, bands) for x in drawn], axis=0))
    # Not off the octave: where a drive jitters near half the rate, the sensor's noise is told larger than that.
    known[0] = known[0] + sensor**2
    told = _powers(motion, left, bands)
    beyond = [x - own for x, own in zip(told, known, strict=True)]
    clear = [
        x > _by_chance(motion, band, len(drawn)) * own
        for x, band, own in zip(told, bands, known, strict=True)
    ]
    # All above the band tells better whether there is any, and the one octave how much of it is in the band.
    power = np.where(np.any(clear, axis=0), np.min(beyond, axis=0), 0.0)
    return np.sqrt(np.maximum(power * _part_inside(motion, left, power), 0.0))


def _part_inside(motion: Motion, left: np.ndarray, power: np.ndarray) -> np.ndarray:
    """Part (T', n) of a power (T', n) of what is sharp that is in the band, where it clearly is not all."""
    begin, end = _INSIDE * motion.torque_cutoff, motion.torque_cutoff
    inside = butterworth(left, motion.rate, begin, _ORDER, high=True)
    inside = butterworth(inside, motion.rate, end, _STEEP)
    samples = _FREEDOM / (2.0 * (end - begin)) * motion.rate
    own = _power(motion, inside, end - begin, max(3, round(samples)))
    rows = max(1, round(samples / motion.decimator.factor))
    above = scipy.ndimage.uniform_filter1d(np.maximum(power, 0.0), rows, axis=0)
    rings = above > times_by_chance(_FREEDOM, 1) * own
    return np.divide(own, above, out=np.ones_like(own), where=rings)


def _by_chance(motion: Motion, band: tuple[float, float], draws: int) -> float:
    """How many times the power that is known noise itself has in a window, but for a chance.

    Known from so many draws of the same window, or else from all of the log.
    """
    return times_by_chance(2.0 * (band[1] - band[0]) * _span(motion), draws)


def times_by_chance(freedom: float, draws: int) -> float:
    """How many times a known power one of so many degrees of freedom is itself, but for a chance.

    Quantiles of F and chi-squared by their inverses alone: the library of distributions takes a third of a
    second to load, a twentieth of a diagnosis.

    Args:
        freedom: Degrees of freedom.
        draws: Independent powers of as many that it is known from; zero: it is known.

    >>> round(times_by_chance(10.0, 2), 2), round(times_by_chance(10.0, 0), 2)
    (3.37, 2.32)
    """
    if draws:
        return float(scipy.special.fdtri(freedom, draws * freedom, 1.0 - _CHANCE))
    return float(scipy.special.chdtri(freedom, _CHANCE) / freedom)


def _powers(
    motion: Motion, left: np.ndarray, bands: Sequence[tuple[float, float]]
) -> list[np.ndarray]:
    """Powers (T', n) below the torque cutoff of what has as much per hertz as in bands [Hz] with one begin."""
    above = butterworth(left, motion.rate, bands[0][0], _ORDER, high=True)
    length = max(3, int(_span(motion) * motion.rate))
    powers = []
    for begin, end in bands:
        own = above if end >= 0.5 * motion.rate else butterworth(above, motion.rate, end, _ORDER)
        powers.append(_power(motion, own, end - begin, length))
    return powers


def _power(motion: Motion, own: np.ndarray, width: float, length: int) -> np.ndarray:
    """Power (T', n) below the torque cutoff of what has as much per hertz as (T, n) in a band of a width [Hz].

    ``length``: samples over which it is averaged.
    """
    power = scipy.ndimage.uniform_filter1d(own**2, length, axis=0)
    return power[motion.decimator.kept(len(motion.t))] * motion.torque_cutoff / width


def _span(motion: Motion) -> float:
    """Time [s] over which the power above the band is averaged."""
    return max(_WINDOW, 1.0 / motion.torque_cutoff)
