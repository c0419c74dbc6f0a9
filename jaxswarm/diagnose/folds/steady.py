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

A drive whose positions are coarse jitters near half the rate, the arm with it, and differences from sample to
sample tell that, too. Noise of the band is no more than what half of the plane holds in the octaves beside the
band's edge. On 40 of 1195 joints of 226 logs of four simulators that is clearly less than the differences or
the octave above tell: the true model leaves 0.03 to 0.8 times the noise of these, 0.2 to 1.1 times that one.
"""

from dataclasses import dataclass, replace

import numpy as np

from jaxswarm.logs.filtering import stretch_spectra
from jaxswarm.logs.motion import Motion

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
# Noise in the band counts from this multiple on of what is told from above it: two readings of white noise
# differ by a fifth.
_CLEARLY = 1.25
# From this multiple on of the most that noise can be, what differences or the octave above tell is no noise
# of the band. Of white noise one log of eight seconds in a hundred goes beyond; of drives that jitter, 4 to 16
# times.
_BEYOND = 1.5
# Squared ratio of the cutoff to the corner: those that are asked.
_STEEP = np.geomspace(1e-3, 1e3, 241)


@dataclass(frozen=True)
class Powers:
    """Power below the cutoff that the octaves of residuals tell on every joint [N^2 m^2 or N^2], all (n,).

    Attributes:
        above: Of what is as strong at all times just above the band. Zero where that octave is not sampled.
        within: Of what fills the octaves of the band itself, as noise of a filter of first order does. Zero
            where the upper octave is not filled evenly.
        most: What noise has at most: by the half of the plane just above the band or in its upper octave, where
            that holds less. Infinite where neither tells.

    NaN is what too short a log does not tell. On the joints of 20 clean logs of two other simulators (noise
    with corners of 3 to 30 Hz among them) the residual is 0.6 to 1.15 times ``within``, on those of 25 logs
    whose law is missing 1.3 to 30 times; what a delay leaves is 0.9 times it, as even as noise.
    """

    above: np.ndarray
    within: np.ndarray
    most: np.ndarray


def steady_powers(left: np.ndarray, rate: float, cutoff: float) -> Powers:
    """What the octaves of residuals (T, n) at a rate [Hz] tell of their power below a cutoff [Hz].

    >>> import scipy
    >>> noise = np.random.default_rng(0).normal(size=(20000, 1))
    >>> slow = scipy.signal.lfilter([1.0], [1.0, -0.6], noise, axis=0)
    >>> fast = scipy.signal.lfilter([1.0], [1.0, 0.6], noise, axis=0)
    >>> for x in (noise, slow, fast):
    ...     told = steady_powers(x, 250.0, 8.0)
    ...     print([round(float(p[0] / (8.0 / 125.0)), 1) for p in (told.above, told.within, told.most)])
    [1.1, 0.9, 1.0]
    [3.8, 5.3, 3.7]
    [0.4, 0.3, 0.4]
    """
    parts = (_QUIET, 0.5)
    beyond = np.full((2, left.shape[1]), np.inf)
    if sampled := _ABOVE[1] * cutoff <= 0.45 * rate:
        beyond = _densities(left, rate, cutoff, (_ABOVE,), _PERIODS, parts)[:, 0]
    quiet, middle = _densities(left, rate, cutoff, _WITHIN[:3], _PERIODS_WITHIN, parts)
    pairs = zip(beyond[0], quiet.T, (middle < _EVEN * quiet).T, strict=True)
    return Powers(
        above=cutoff * beyond[0] if sampled else np.zeros(left.shape[1]),
        within=cutoff * np.array([_of_first_order(a, own, even) for a, own, even in pairs]),
        most=cutoff * np.nan_to_num(np.fmin(beyond[1], middle[0]), nan=np.inf, posinf=np.inf),
    )


def with_steady_noise(motion: Motion, left: np.ndarray, drawn: list[np.ndarray]) -> Motion:
    """The same log with the steady noise that the doubt of its motion does not make, and the bounded noise.

    Args:
        motion: Whose noise it is.
        left: What a model leaves of it on its working clock, (T, n).
        drawn: What draws of the noise of its positions make of the model's torque, each (T, n).
    """
    assert motion.torque_noise is not None  # of a log with a torque
    of_all, *of_drawn = [
        steady_powers(x, motion.rate, motion.torque_cutoff) for x in (left, *drawn)
    ]
    told = np.array([(x.above, x.within) for x in (of_all, *of_drawn)])
    of_motion = told[1:].sum(axis=0) / max(len(drawn), 1)
    above, within = np.sqrt(np.maximum(told[0] - of_motion, 0.0))
    most = np.sqrt(of_all.most)
    above, sensor = _at_most(above, most), _at_most(motion.torque_noise, most)
    known = np.maximum(np.nan_to_num(above), sensor)
    steady = np.where(within > _CLEARLY * known, within, above)
    return replace(motion, steady_noise=steady, bounded_noise=sensor)


def _at_most(noise: np.ndarray, most: np.ndarray) -> np.ndarray:
    """Noise (n,) where it is not clearly beyond the most that it can be, else that."""
    return np.where(noise > _BEYOND * most, most, noise)


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
