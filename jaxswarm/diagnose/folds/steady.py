"""Noise that is as strong at all times and frequencies just above the compared band: it is in it as well.

A current loop or a torque sensor behind a filter has noise that is stronger where it is slow, of which
differences from sample to sample tell a part alone: half of it where two neighbors at 250 Hz are alike to 0.6.
What a law leaves above the compared band comes in bursts and in lines. Noise fills the plane of time and
frequency there evenly, and is read off where that plane is quiet.
"""

import numpy as np

from jaxswarm.logs.filtering import stretch_spectra

# The octave that is looked at begins here over the cutoff, where the low-pass has left nothing of the band.
_BEGIN = 1.5
# Length of a stretch in periods of the cutoff, and the stretches that are needed to tell.
_PERIODS, _STRETCHES = 4.0, 8
# Part of the plane that is taken as quiet. What is missing and fills half of the plane doubles the power told.
_QUIET = 0.25


def steady_power(left: np.ndarray, rate: float, cutoff: float) -> np.ndarray:
    """Power (n,) below a cutoff [Hz] of residuals (T, n) at a rate [Hz] that have it at all times just above.

    Zero where the octave above the cutoff is not sampled, or the log is too short to tell.

    >>> import scipy
    >>> noise = np.random.default_rng(0).normal(size=(20000, 1))
    >>> slow = scipy.signal.lfilter([1.0], [1.0, -0.6], noise, axis=0)
    >>> [round(float(steady_power(x, 250.0, 8.0)[0] / (8.0 / 125.0))) for x in (noise, slow)]
    [1, 4]
    """
    length = int(round(_PERIODS * rate / cutoff))
    if 2.0 * _BEGIN * cutoff > 0.45 * rate or len(left) < (_STRETCHES + 1) * length // 2:
        return np.zeros(left.shape[1])
    frequency, spectra = stretch_spectra(left, rate, length)
    octave = (frequency >= _BEGIN * cutoff) & (frequency < 2.0 * _BEGIN * cutoff)
    power = np.stack([density[octave] for density in spectra])
    # A line of white noise is exponentially distributed about its mean.
    usual = np.quantile(power, _QUIET, axis=(0, 1)) / -np.log1p(-_QUIET)
    return cutoff * usual
