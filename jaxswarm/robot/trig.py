r"""Sine and cosine as polynomials, so that what goes through many samples or lanes vectorizes on a CPU.

XLA on a CPU calls the library's sine one element at a time. This pair is plain arithmetic: half the
angle is reduced to :math:`h = x/2 - k \pi` with :math:`|h| \le \pi/2` and :math:`k` the nearest
integer to :math:`x / 2\pi`, :math:`\pi` split in two parts of which the first multiplies :math:`k`
without rounding (Cody and Waite 1980); polynomials in :math:`h^2` that interpolate at Chebyshev nodes
give its sine and cosine, and doubling the angle,

.. math:: \sin x = 2 \sin h \cos h, \qquad \cos x = \cos^2 h - \sin^2 h,

needs neither a sign nor a quadrant to be selected. The results are settled (see
:func:`jaxswarm.robot.spatial.settle`): XLA would evaluate them again for every value they enter.

Error: below 1e-15 absolute for :math:`|x| \le 10^5` rad in float64 (tested); the polynomials' own is
4e-17. Angles beyond lose accuracy in proportion, as does the angle itself. Other dtypes use the
library's functions.
"""

import math
from typing import Any

import jax
import jax.numpy as jnp

from jaxswarm.robot.spatial import settle

MAX_ERROR = 1e-15  # absolute, for |angle| <= MAX_ANGLE
MAX_ANGLE = 1e5  # rad

# pi = _PI_HIGH + _PI_LOW; the first has 38 bits, so that k times it is exact.
_PI_HIGH = float.fromhex("0x1.921fb5444p+1")
_PI_LOW = float.fromhex("0x1.68c234c4c6629p-38")
# sin(h) / h and cos(h) in powers of h^2, on |h| <= pi/2.
_SINE = (
    1.0,
    -0.16666666666666666,
    0.008333333333333316,
    -0.00019841269841254974,
    2.755731921916321e-06,
    -2.5052107616993267e-08,
    1.6058977312275076e-10,
    -7.643970290763911e-13,
    2.73144469174093e-15,
)
_COSINE = (
    1.0,
    -0.5,
    0.04166666666666634,
    -0.0013888888888860709,
    2.480158729244617e-05,
    -2.7557317767315006e-07,
    2.0876630867064916e-09,
    -1.1464689874287748e-11,
    4.6276758424721294e-14,
)


def polynomial_sincos(angle: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return sine and cosine of an angle in rad, elementwise.

    >>> sine, cosine = polynomial_sincos(jnp.zeros(2))
    >>> sine.tolist(), cosine.tolist()
    ([0.0, 0.0], [1.0, 1.0])
    """
    angle = jnp.asarray(angle)
    if angle.dtype != jnp.float64:
        return jnp.sin(angle), jnp.cos(angle)
    k = jax.lax.stop_gradient(jnp.round(angle * (0.5 / math.pi)))
    half = (0.5 * angle - k * _PI_HIGH) - k * _PI_LOW
    square = half * half
    sine, cosine = half * _horner(_SINE, square), _horner(_COSINE, square)
    return settle((2.0 * sine * cosine, cosine * cosine - sine * sine))


def _horner(coefficients: tuple[float, ...], x: jax.Array) -> jax.Array:
    result: Any = coefficients[-1]
    for c in reversed(coefficients[:-1]):
        result = result * x + c
    return result
