r"""Noise that is as strong at all times and frequencies of an octave, just above the compared band or in it.

A current loop or a torque sensor behind a filter has noise that is stronger where it is slow, of which
differences from sample to sample tell a part alone: half of it where two neighbors at 250 Hz are alike to 0.6.
What a law leaves comes in bursts and in lines. Noise fills the plane of time and frequency evenly, and is read
off where that plane is quiet: in the octave above the band, and in the octaves of the band where its corner
lies within. Of a filter of first order its density at a frequency f is

.. math:: S(f) = S_0 / (1 + (f / f_c)^2),

whose corner :math:`f_c` follows from how much more there is in the second octave of the band than in the upper
one, and which tells of the slowest octaves, where laws are: no more than is found there, and in all no more
than goes with what the octave above holds.
"""

import numpy as np

from jaxswarm.logs.filtering import stretch_spectra

# Octaves above the band and in it, from the upper one down, over the cutoff: where the low-pass has left
# nothing of the band, and what it passes.
_ABOVE = (1.5, 3.0)
_WITHIN = ((0.5, 1.0), (0.25, 0.5), (0.125, 0.25), (0.0, 0.125))
# Length of a stretch in periods of the cutoff, for the octave above and for those within, of which the third
# is one line; and the stretches that are needed to tell. Of noise of a known corner (0.3 to 2 times the cutoff,
# 50 to 500 Hz, 16 and 40 s) 0.8 to 1.3 times its size is told in nine of ten.
_PERIODS, _PERIODS_WITHIN, _STRETCHES = 4.0, 8.0, 8
# Part of the plane that is taken as quiet. What is missing and fills half of the plane doubles the power told.
_QUIET = 0.25
# Evenly filled is an octave of the band whose median tells at most this many times the power that its quiet
# part tells: of noise 0.8 to 1.3 times.
_EVEN = 1.35
# Squared ratio of the cutoff to the corner: those that are asked.
_STEEP = np.geomspace(1e-3, 1e3, 241)


def steady_power(left: np.ndarray, rate: float, cutoff: float) -> np.ndarray:
    """Power (n,) below a cutoff [Hz] of residuals (T, n) at a rate [Hz] that have it at all times just above.

    Zero where the octave above the cutoff is not sampled, NaN where the log is too short to tell.

    >>> import scipy
    >>> noise = np.random.default_rng(0).normal(size=(20000, 1))
    >>> slow = scipy.signal.lfilter([1.0], [1.0, -0.6], noise, axis=0)
    >>> [round(float(steady_power(x, 250.0, 8.0)[0] / (8.0 / 125.0))) for x in (noise, slow)]
    [1, 4]
    """
    if _ABOVE[1] * cutoff > 0.45 * rate:
        return np.zeros(left.shape[1])
    return cutoff * _densities(left, rate, cutoff, (_ABOVE,), _PERIODS, (_QUIET,))[0, 0]


def band_power(
    left: np.ndarray, rate: float, cutoff: float, beside: np.ndarray | None = None
) -> np.ndarray:
    """The same (n,) of what fills the octaves of the band itself, as noise of a filter of first order does.

    Zero where the upper octave is not filled evenly, NaN where the log is too short to tell. ``beside``: what
    :func:`steady_power` gave, so that the octave above is not read twice.

    On the joints of 20 clean logs of two other simulators (noise with corners of 3 to 30 Hz among them) the
    residual is 0.6 to 1.15 times it, on those of 25 logs whose law is missing 1.3 to 30 times; what a delay
    leaves is 0.9 times it, as even as noise.

    >>> import scipy
    >>> noise = np.random.default_rng(0).normal(size=(20000, 1))
    >>> slow = scipy.signal.lfilter([1.0], [1.0, -0.6], noise, axis=0)
    >>> [round(float(band_power(x, 250.0, 8.0)[0] / (8.0 / 125.0))) for x in (noise, slow)]
    [1, 5]
    """
    above = np.full(left.shape[1], np.inf)
    if _ABOVE[1] * cutoff <= 0.45 * rate:
        above = (steady_power(left, rate, cutoff) if beside is None else beside) / cutoff
    quiet, middle = _densities(left, rate, cutoff, _WITHIN[:3], _PERIODS_WITHIN, (_QUIET, 0.5))
    pairs = zip(above, quiet.T, (middle < _EVEN * quiet).T, strict=True)
    return cutoff * np.array([_of_first_order(a, own, even) for a, own, even in pairs])


def _densities(
    left: np.ndarray, rate: float, cutoff: float, octaves: tuple, periods: float, parts: tuple
) -> np.ndarray:
    """Power density (parts, octaves, n) that parts of every octave's plane tell; NaN of too few stretches."""
    length = int(round(periods * rate / cutoff))
    if len(left) < (_STRETCHES + 1) * length // 2:
        return np.full((len(parts), len(octaves), left.shape[1]), np.nan)
    frequency, spectra = stretch_spectra(left, rate, length)
    lowest, highest = octaves[-1][0] * cutoff, octaves[0][1] * cutoff
    asked = (frequency >= lowest) & (frequency < highest)
    # All lines of a long log would take twice its memory.
    power, frequency = np.stack([density[asked] for density in spectra]), frequency[asked]
    inside = [(frequency >= a * cutoff) & (frequency < b * cutoff) for a, b in octaves]
    # A line of white noise is exponentially distributed about its mean.
    mean = -np.log1p(-np.array(parts))[:, None, None]
    return np.stack([np.quantile(power[:, i], parts, axis=(0, 1)) for i in inside], axis=1) / mean


def _of_first_order(above: float, within: np.ndarray, even: np.ndarray) -> float:
    """Mean density below the cutoff of noise with the densities of the octave above (infinite: not known) and
    of three octaves within, from the upper one down, each of which is filled evenly or not.
    """
    upper, second, third = within
    if np.isnan(upper) or not even[0]:
        return 0.0 * float(upper)
    rise, rises = (
        second / max(upper, 1e-300),
        _means(_STEEP, _WITHIN[1]) / _means(_STEEP, _WITHIN[0]),
    )
    # More than that filter's is what a law leaves; of noise the band holds at least what its upper octave does.
    noise = even[1] and rise < rises[-1]
    steep = np.interp(rise, rises, _STEEP) if noise else _STEEP[0]
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
