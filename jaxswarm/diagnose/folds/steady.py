r"""Noise that is as strong at all times and frequencies of an octave, just above the compared band or in it.

A current loop or a torque sensor behind a filter has noise that is stronger where it is slow, of which
differences from sample to sample tell a part alone: half of it where two neighbors at 250 Hz are alike to 0.6.
What a law leaves comes in bursts and in lines. Noise fills the plane of time and frequency evenly, and is read
off where that plane is quiet: in the octave above the band, and in the octaves of the band where its corner
lies within. Of a filter of first order its density at a frequency f is

.. math:: S(f) = S_0 / (1 + (f / f_c)^2),

whose corner :math:`f_c` and density follow from the octave above the band and the upper two within, where these
are those of one such filter, by least squares of their logarithms. It tells of the slowest octaves, where laws
are: no more than is found there. Where they are not, the two within tell the corner, and noise is no more than
goes with what the octave above holds.

A drive whose positions are coarse jitters near half the rate, the arm with it, and differences from sample to
sample tell that, too. Noise of the band is no more than what half of the plane holds in the octaves beside the
band's edge. On 40 of 1195 joints of 226 logs of four simulators that is clearly less than the differences or
the octave above tell: the true model leaves 0.03 to 0.8 times the noise of these, 0.2 to 1.1 times that one.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from jaxswarm.diagnose.folds.first_order import ABOVE, WITHIN, density_of, standard_errors
from jaxswarm.logs.filtering import stretch_spectra, stretches
from jaxswarm.logs.motion import Motion

# Length of a stretch in periods of the cutoff, for the octave above and for those within, of which the third
# is one line; and the stretches that are needed to tell. Of noise of a known corner (0.3 to 2 times the cutoff,
# 50 to 500 Hz) 0.8 to 1.3 times its size is told in 84 of a hundred logs of 8 s, in 91 of those of 16 and 40 s.
_PERIODS, _PERIODS_WITHIN, _STRETCHES = 4.0, 8.0, 8
# Part of the plane that is taken as quiet. What is missing and fills half of the plane doubles the power told.
_QUIET = 0.25
# Evenly filled is an octave of the band whose median tells at most this many times the power that its quiet
# part tells: of noise 0.8 to 1.3 times.
_EVEN = 1.35
# The same beyond one as a multiple of the relative standard error of a few lines.
_EVEN_OF_FEW = 1.5
# Noise in the band counts from this multiple on of what is told from above it: two readings of white noise
# differ by a fifth.
_CLEARLY = 1.25
# From this multiple on of the most that noise can be, what differences or the octave above tell is no noise
# of the band. Of white noise one log of eight seconds in a hundred goes beyond; of drives that jitter, 4 to 16
# times.
_BEYOND = 1.5


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


def steady_powers(
    left: np.ndarray, rate: float, cutoff: float, out: np.ndarray | None = None
) -> Powers:
    """What the octaves of residuals (T, n) at a rate [Hz] tell of their power below a cutoff [Hz].

    Samples that are ``out`` (T, n) tell nothing, as where dry friction holds a joint; None: all do.

    >>> import scipy
    >>> noise = np.random.default_rng(0).normal(size=(20000, 1))
    >>> slow = scipy.signal.lfilter([1.0], [1.0, -0.6], noise, axis=0)
    >>> fast = scipy.signal.lfilter([1.0], [1.0, 0.6], noise, axis=0)
    >>> for x in (noise, slow, fast):
    ...     told = steady_powers(x, 250.0, 8.0)
    ...     print([round(float(p[0] / (8.0 / 125.0)), 1) for p in (told.above, told.within, told.most)])
    [1.1, 0.9, 1.0]
    [3.8, 5.3, 3.7]
    [0.4, 0.4, 0.4]
    """
    parts = (_QUIET, 0.5)
    beyond = np.full((2, left.shape[1]), np.inf)
    if sampled := ABOVE[1] * cutoff <= 0.45 * rate:
        beyond = _densities(left, rate, cutoff, (ABOVE,), _PERIODS, parts, out)[:, 0]
    quiet, middle = _densities(left, rate, cutoff, WITHIN[:3], _PERIODS_WITHIN, parts, out)
    doubt = standard_errors(len(left) * cutoff / rate, _QUIET)
    even = np.maximum(_EVEN, 1.0 + _EVEN_OF_FEW * doubt[1:])[:, None]
    pairs = zip(beyond[0], quiet.T, (middle[:2] < even * quiet[:2]).T, strict=True)
    return Powers(
        above=cutoff * beyond[0] if sampled else np.zeros(left.shape[1]),
        within=cutoff * np.array([density_of(a, own, even, doubt) for a, own, even in pairs]),
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
    out = _not_fitted(motion)
    of_all, *of_drawn = [
        steady_powers(x, motion.rate, motion.torque_cutoff, out) for x in (left, *drawn)
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


def _not_fitted(motion: Motion) -> np.ndarray | None:
    """The samples (T, n) whose rows are left out of the fit; None if there are none."""
    if motion.held is None or not motion.held.any():
        return None
    kept = motion.decimator.kept(len(motion.t))
    nearest = np.rint((np.arange(len(motion.t)) - kept[0]) / motion.decimator.factor).astype(int)
    return motion.held[np.clip(nearest, 0, len(kept) - 1)]


def _densities(
    left: np.ndarray,
    rate: float,
    cutoff: float,
    octaves: tuple,
    periods: float,
    parts: tuple,
    out: np.ndarray | None = None,
) -> np.ndarray:
    """Power density (parts, octaves, n) that parts of every octave's plane tell; NaN of too few stretches.

    Without those of each joint in whose middle some samples are out, where enough others are left.
    """
    length = int(round(periods * rate / cutoff))
    if len(left) < (_STRETCHES + 1) * length // 2:
        return np.full((len(parts), len(octaves), left.shape[1]), np.nan)
    frequency, spectra = stretch_spectra(left, rate, length)
    lowest, highest = octaves[-1][0] * cutoff, octaves[0][1] * cutoff
    asked = (frequency >= lowest) & (frequency < highest)
    # All lines of a long log would take twice its memory.
    power, frequency = np.stack([density[asked] for density in spectra]), frequency[asked]
    inside = [(frequency >= a * cutoff) & (frequency < b * cutoff) for a, b in octaves]
    quantile: Callable = np.quantile
    if out is not None:
        middle = slice(length // 4, length - length // 4)
        spoiled = np.stack([out[part][middle].any(axis=0) for part in stretches(len(left), length)])
        spoiled &= (~spoiled).sum(axis=0) >= _STRETCHES
        power, quantile = np.where(spoiled[:, None], np.nan, power), np.nanquantile
    # A line of white noise is exponentially distributed about its mean.
    mean = -np.log1p(-np.array(parts))[:, None, None]
    return np.stack([quantile(power[:, i], parts, axis=(0, 1)) for i in inside], axis=1) / mean
