r"""Random motion that stands still from time to time: an effect that grows with rest is told on no other.

The usual random motion is run through by a clock that stops and goes on,

.. math:: q(t) = q_0(s(t)), \quad \dot q = \dot q_0(s)\,\dot s, \quad
   \ddot q = \ddot q_0(s)\,\dot s^2 + \dot q_0(s)\,\ddot s,

so that all joints keep their range and stand together, each time for another while.
"""

import numpy as np
import scipy

from jaxswarm.identify.synthetic import fourier_motion

# Rests, how long they last [s], and the time [s] in which the clock comes to its stop and leaves it.
_RESTS, _LASTING, _RAMP = 12, (0.3, 4.0), 0.3
# The motion is known so many times as densely as it is sampled.
_FINER = 10


def halting_motion(
    joints: int, rng: np.random.Generator, duration: float = 20.0, rate: float = 250.0
) -> tuple[np.ndarray, ...]:
    """Motion of so many seconds, with rests on top: t (T,), q, dq, ddq (T, n)."""
    fine, *moved = fourier_motion(joints, rng, duration, rate * _FINER)
    lasting = np.exp(rng.uniform(*np.log(_LASTING), _RESTS))
    # No two rests come closer than their ramps: one to each stretch of the motion.
    stretch = (fine[-1] - 4.0 * _RAMP) / _RESTS
    begins = (np.arange(_RESTS) + rng.uniform(0.0, 0.5, _RESTS)) * stretch + _RAMP
    begins += np.concatenate([[0.0], np.cumsum(lasting)[:-1]])
    t = np.arange(int((fine[-1] - _RAMP + lasting.sum()) * rate)) / rate
    clock, pace, change = t.copy(), np.ones_like(t), np.zeros_like(t)
    for begin, last in zip(begins, lasting, strict=True):
        for sign, start in ((-1.0, begin), (1.0, begin + last)):
            told = _step((t - start) / _RAMP)
            clock += sign * _RAMP * told[0]
            pace += sign * told[1]
            change += sign * told[2] / _RAMP
    q, dq, ddq = (scipy.interpolate.CubicSpline(fine, x)(clock) for x in moved)
    pace, change = pace[:, None], change[:, None]
    return t, q, dq * pace, ddq * pace**2 + dq * change


def _step(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Integral, value and slope of a smooth step from zero to one between zero and one."""
    y = np.clip(x, 0.0, 1.0)
    integral = 2.5 * y**4 - 3.0 * y**5 + y**6 + np.maximum(x - 1.0, 0.0)
    return integral, y**3 * (10.0 - 15.0 * y + 6.0 * y**2), 30.0 * y**2 * (1.0 - y) ** 2
