r"""Periodic motions within limits that start and end at rest.

Joint j moves as a finite Fourier series (J. Swevers et al., IEEE Trans. Robotics and Automation 13
(1997)), with velocity

.. math:: \dot q_j(t) = \sum_{l=1}^L a_{jl} \cos(l\omega t) + b_{jl} \sin(l\omega t).

It is at rest at every multiple of the period, without a jump of the acceleration, if
:math:`\sum_l a_{jl} = 0` and :math:`\sum_l l\,b_{jl} = 0`: the coefficients are projected on that. The
amplitude is then as large as position, velocity and acceleration limits allow, so that no search has to
learn them. A series of L harmonics rises between K equidistant samples by at most
:math:`1/\cos(\pi L/K)` (H. Ehlich, K. Zeller, Math. Zeitschrift 86 (1964)), so the limits hold at all
times and not only at the samples.
"""

from dataclasses import dataclass, replace

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.identify.excitation.limits import Limits

# Kept from the limits, so that rounding in a written file does not cross them.
_MARGIN = 1e-6
# Least share of the largest amplitude a search tries where it may make a motion smaller.
_LEAST = 0.02


@dataclass(frozen=True)
class Fourier:
    """A periodic motion: ``q = offset + sum_l sine_l sin(l w t) + cosine_l cos(l w t)``.

    Attributes:
        offset: [rad or m], shape (n,).
        sine, cosine: Amplitudes [rad or m], shape (n, L).
        fundamental: Frequency of the period [Hz].
    """

    offset: np.ndarray
    sine: np.ndarray
    cosine: np.ndarray
    fundamental: float

    def smaller(self, factor: float) -> "Fourier":
        """The motion with a share of its amplitudes, about the same place."""
        return replace(self, sine=factor * self.sine, cosine=factor * self.cosine)

    def motion(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position, velocity, acceleration at times t [s] (T,), each (T, n)."""
        omega = 2 * np.pi * self.fundamental * np.arange(1, self.sine.shape[1] + 1)
        s, c = np.sin(np.outer(t, omega)), np.cos(np.outer(t, omega))
        a, b = self.sine.T, self.cosine.T
        w = omega[:, None]
        return (
            self.offset + s @ a + c @ b,
            c @ (w * a) - s @ (w * b),
            -s @ (w**2 * a) - c @ (w**2 * b),
        )


def num_coordinates(limits: Limits) -> int:
    """Numbers that describe a motion: 2 L coefficients, a place in the range and, if free, a size a joint."""
    return len(limits.lower) * (2 * limits.harmonics + (2 if limits.smaller else 1))


def shares(x: jax.Array, limits: Limits) -> jax.Array:
    """Size of every joint's motion as a share of the largest one its limits allow, (n,)."""
    rows = jnp.reshape(x, (len(limits.lower), -1))
    if not limits.smaller:
        return jnp.ones(len(rows))
    return _LEAST + (1.0 - _LEAST) * 0.5 * (1.0 + rows[:, -1])


def widest(x: np.ndarray, limits: Limits, fundamental: float, samples: int) -> Fourier:
    """The largest motion of a given shape, see :func:`within_limits`."""
    offset, sine, cosine = within_limits(jnp.asarray(x), limits, fundamental, samples)
    return Fourier(np.asarray(offset), np.asarray(sine), np.asarray(cosine), fundamental)


def within_limits(
    x: jax.Array, limits: Limits, fundamental: float, samples: int
) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Offset (n,), sine and cosine amplitudes (n, L) of the largest motion of a given shape.

    Args:
        x: Shape and place of the motion, ``n (2 L + 1)`` numbers in [-1, 1]; where it may be smaller than
            the limits ask, ``n (2 L + 2)``.
        limits: What it has to keep.
        fundamental: Frequency of the period [Hz].
        samples: Samples of one period on which peaks are looked for, more than 2 L.

    >>> one = Limits(*np.array([[-1.0], [1.0], [2.0], [3.0]]), harmonics=2)
    >>> offset, sine, cosine = within_limits(jnp.array([1.0, 0.0, 0.0, 0.0, 0.0]), one, 0.2, 64)
    >>> q, dq, ddq = Fourier(offset, sine, cosine, 0.2).motion(np.linspace(0.0, 5.0, 500))
    >>> bool(abs(q).max() <= 1 and abs(dq).max() <= 2 and abs(ddq).max() <= 3)
    True
    >>> bool(abs(dq[0, 0]) < 1e-12)
    True
    """
    size = limits.harmonics
    order = np.arange(1, size + 1)
    rows = jnp.reshape(x, (len(limits.lower), -1))
    a, b, place = rows[:, :size], rows[:, size : 2 * size], rows[:, 2 * size]
    a = a - a.mean(axis=1, keepdims=True)
    b = b - (b @ order)[:, None] * order / (order @ order)
    omega = 2 * np.pi * fundamental * order
    angle = 2 * np.pi * np.outer(np.arange(samples) / samples, order)
    s, c = np.sin(angle).T, np.cos(angle).T
    q = (a / omega) @ s - (b / omega) @ c
    dq = a @ c + b @ s
    ddq = (b * omega) @ c - (a * omega) @ s
    high, low = q.max(axis=1), q.min(axis=1)
    rise = (1.0 + _MARGIN) / np.cos(np.pi * size / samples)
    room = 0.5 * (limits.upper - limits.lower)
    use = jnp.maximum(
        0.5 * rise * (high - low) / room,
        rise * jnp.maximum(
            jnp.abs(dq).max(axis=1) / limits.velocity,
            jnp.abs(ddq).max(axis=1) / limits.acceleration,
        ),
    )  # fmt: skip
    scale = shares(x, limits) / jnp.maximum(use, 1e-12)
    left = room - scale * 0.5 * rise * (high - low)
    middle = 0.5 * (limits.upper + limits.lower) + place * jnp.maximum(left, 0.0)
    offset = middle - scale * 0.5 * (high + low)
    return offset, scale[:, None] * a / omega, -scale[:, None] * b / omega
