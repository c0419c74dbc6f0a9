"""A log with the noise of its positions once more: what is not known of its motion."""

from dataclasses import replace

import numpy as np
import scipy

from jaxswarm.logs.filtering import derivatives
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.smoothing import smooth

# Where a joint's acceleration is less than this part of what the noise of its positions makes there is no such
# noise: over so long [s] white noise alone is within a third of its own.
_LESS, _WINDOW = 0.5, 0.25


def noisy(motion: Motion, share: float, rng: np.random.Generator) -> Motion:
    """A log smoothed once more, with so many times the white noise of its positions, which has to be known.

    It is as large as it is seen to be: an encoder's steps are none while its joint stands. Through the sharp
    sign of its friction that noise was seven times a drift of friction that was there in motion, and "nothing
    missing" was said of it.
    """
    drawn = rng.normal(size=(2, *motion.q.shape))
    drawn *= share * _seen(motion, drawn) if share else 0.0
    more, faster = _noise(motion, drawn)
    given = None if faster is None else motion.dq + faster
    q, dq, ddq = _smoothed(motion, motion.q + more, given)
    return replace(motion, q=q, dq=dq, ddq=ddq)


def _seen(motion: Motion, drawn: np.ndarray) -> np.ndarray:
    """Part of the noise of the positions that a log shows at most, (T, n), by draws of it, (2, T, n)."""
    usual = np.sqrt((_smoothed(motion, *_noise(motion, drawn))[2] ** 2).mean(axis=0))
    length = max(3, round(_WINDOW * motion.rate))
    power = scipy.ndimage.uniform_filter1d(motion.ddq**2, length, axis=0)
    here = np.sqrt(np.maximum(power, 0.0))  # a running sum goes below zero
    part = np.divide(here, usual, out=np.ones_like(here), where=usual > 0.0)
    return np.where(part < _LESS, part, 1.0)


def _noise(motion: Motion, drawn: np.ndarray) -> tuple[np.ndarray, np.ndarray | None]:
    """Noise (T, n) of the positions, and of the velocities if they are logged, by draws (2, T, n)."""
    noise, ratio = motion.position_noise, motion.velocity_ratio
    assert noise is not None  # asked for where it is known
    return noise * drawn[0], None if ratio is None else noise / np.sqrt(ratio) * drawn[1]


def _smoothed(
    motion: Motion, q: np.ndarray, dq: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions (T, n) and velocities as the log's are smoothed, with two derivatives."""
    cutoff = np.array(motion.motion_cutoff)
    q = smooth(q, motion.rate, cutoff, dq, motion.velocity_ratio)
    first, second = derivatives(q, motion.rate, 2)
    return q, first, second
