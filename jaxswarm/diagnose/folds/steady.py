r"""Noise that is as strong at all times and frequencies of an octave, just above the compared band and in it.

A current loop or a torque sensor behind a filter has noise that is stronger where it is slow, of which
differences from sample to sample tell a part alone: half of it where two neighbors at 250 Hz are alike to 0.6.
What a law leaves comes in bursts and in lines. Noise fills the plane of time and frequency evenly, and is read
off where that plane is quiet: in the octave above the band where it is sampled, and in the octaves of the band.
Of a filter of first order its density at a frequency f is

.. math:: S(f) = S_0 / (1 + (f / f_c)^2),

whose corner :math:`f_c` follows from how much more there is in the octave below the upper one of the band, and
which tells of the slowest octaves, where laws are. It holds there no more than is found, and no more in all
than goes with what the octave above holds.
"""

import numpy as np

from jaxswarm.logs.filtering import stretch_spectra

# Octaves above the band and in it, from the upper one down, over the cutoff: where the low-pass has left
# nothing of the band, and thrice what it passes.
_ABOVE = (1.5, 3.0)
_WITHIN = ((0.5, 1.0), (0.25, 0.5), (0.125, 0.25), (0.0, 0.125))
# Length of a stretch in periods of the cutoff, for the octave above and for those within, of which the third
# is one line; and the stretches that are needed to tell. On noise of a known corner (0.3 to 2 times the cutoff,
# 50 to 500 Hz, 16 and 40 s) 0.8 to 1.3 times its size is told in nine of ten.
_PERIODS, _PERIODS_WITHIN, _STRETCHES = 4.0, 8.0, 8
# Part of the plane that is taken as quiet. What is missing and fills half of the plane doubles the power told.
_QUIET = 0.25
# Squared ratio of the cutoff to the corner: those that are asked.
_STEEP = np.geomspace(1e-3, 1e3, 241)


def steady_power(left: np.ndarray, rate: float, cutoff: float) -> np.ndarray:
    """Power (n,) below a cutoff [Hz] of residuals (T, n) at a rate [Hz] that is noise at all times.

    NaN where the log is too short to tell.

    On the joints of 20 clean logs of two other simulators (noise with corners of 3 to 30 Hz among them) the
    residual is 0.6 to 1.15 times it, on those of 25 logs whose law is missing 1.3 to 30 times; what a delay
    leaves is 0.9 times it, as even as noise.

    >>> import scipy
    >>> noise = np.random.default_rng(0).normal(size=(20000, 1))
    >>> slow = scipy.signal.lfilter([1.0], [1.0, -0.6], noise, axis=0)
    >>> [round(float(steady_power(x, 250.0, 8.0)[0] / (8.0 / 125.0))) for x in (noise, slow)]
    [1, 5]
    """
    above = np.full(left.shape[1], np.inf)
    if _ABOVE[1] * cutoff <= 0.45 * rate:
        (above,) = _densities(left, rate, cutoff, (_ABOVE,), _PERIODS)
    within = _densities(left, rate, cutoff, _WITHIN[:3], _PERIODS_WITHIN)
    flat = np.where(np.isinf(above), 0.0, above)
    told = [_of_first_order(*each) for each in zip(above, within.T, strict=True)]
    return cutoff * np.fmax(flat, told)


def _densities(
    left: np.ndarray, rate: float, cutoff: float, octaves: tuple, periods: float
) -> np.ndarray:
    """Power density (octaves, n) of what is steady in every octave; NaN of too few stretches."""
    length = int(round(periods * rate / cutoff))
    if len(left) < (_STRETCHES + 1) * length // 2:
        return np.full((len(octaves), left.shape[1]), np.nan)
    frequency, spectra = stretch_spectra(left, rate, length)
    lowest, highest = octaves[-1][0] * cutoff, octaves[0][1] * cutoff
    asked = (frequency >= lowest) & (frequency < highest)
    # All lines of a long log would take twice its memory.
    power, frequency = np.stack([density[asked] for density in spectra]), frequency[asked]
    inside = [(frequency >= a * cutoff) & (frequency < b * cutoff) for a, b in octaves]
    # A line of white noise is exponentially distributed about its mean.
    return np.stack(
        [np.quantile(power[:, each], _QUIET, axis=(0, 1)) / -np.log1p(-_QUIET) for each in inside]
    )


def _of_first_order(above: float, within: np.ndarray) -> float:
    """Mean density below the cutoff of noise with the densities of the octave above (infinite: not known) and
    of three octaves within, from the upper one down.
    """
    upper, second, third = within
    if not upper > 0.0:
        return float(upper)
    rise, rises = second / upper, _means(_STEEP, _WITHIN[1]) / _means(_STEEP, _WITHIN[0])
    # More than that filter's is what a law leaves; of noise the band holds at least what its upper octave does.
    steep = np.interp(rise, rises, _STEEP) if rise < rises[-1] else _STEEP[0]
    beyond, first, *below = [_means(np.array(steep), octave) for octave in (_ABOVE, *_WITHIN)]
    upper = min(upper, above * first / beyond)
    per_upper = np.array(below) / first
    slow = min(third, per_upper[1] * upper)
    parts = (upper, per_upper[0] * upper, slow, slow * per_upper[2] / per_upper[1])
    return float(sum(part * (b - a) for part, (a, b) in zip(parts, _WITHIN, strict=True)))


def _means(steep: np.ndarray, octave: tuple[float, float]) -> np.ndarray:
    """Mean of 1 / (1 + steep f^2) over frequencies f [cutoffs] of an octave."""
    begin, end = octave
    root = np.sqrt(steep)
    return (np.arctan(root * end) - np.arctan(root * begin)) / (root * (end - begin))
