r"""Sine and cosine as polynomials, so that a scan over many lanes vectorizes on a CPU.

XLA on a CPU calls the library's sine one element at a time. This pair is plain arithmetic: the angle
is reduced to :math:`r = x - k \pi` with :math:`|r| \le \pi/2` and :math:`k` the nearest integer,
:math:`\pi` split in three parts of which the first two multiply :math:`k` without rounding (Cody
and Waite 1980), then both Taylor series are summed as polynomials in :math:`r^2`; the sign is that of
:math:`(-1)^k`. Reducing by :math:`\pi` instead of :math:`\pi/2` costs five more multiply-adds and saves
the selection by quadrant.

Error: below 1e-15 absolute for :math:`|x| \le 10^5` rad in float64 (tested); the truncated terms are
below 2e-17. Angles beyond lose accuracy in proportion, as does the angle itself. Other dtypes use
the library's functions.
"""

import math

import jax
import jax.numpy as jnp

MAX_ERROR = 1e-15  # absolute, for |angle| <= MAX_ANGLE
MAX_ANGLE = 1e5  # rad

# pi = _PI_HIGH + _PI_MIDDLE + _PI_LOW; the first two have 33 bits, so that k * part is exact.
_PI_HIGH = float.fromhex("0x1.921fb544p+1")
_PI_MIDDLE = float.fromhex("0x1.0b4611a6p-33")
_PI_LOW = float.fromhex("0x1.3198a2e037073p-68")
_SINE = tuple((-1) ** n / math.factorial(2 * n + 1) for n in range(11))
_COSINE = tuple((-1) ** n / math.factorial(2 * n) for n in range(11))


def polynomial_sincos(angle: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return sine and cosine of an angle in rad, elementwise.

    >>> sine, cosine = polynomial_sincos(jnp.zeros(2))
    >>> sine.tolist(), cosine.tolist()
    ([0.0, 0.0], [1.0, 1.0])
    """
    angle = jnp.asarray(angle)
    if angle.dtype != jnp.float64:
        return jnp.sin(angle), jnp.cos(angle)
    k = jax.lax.stop_gradient(jnp.round(angle * (1.0 / math.pi)))
    r = ((angle - k * _PI_HIGH) - k * _PI_MIDDLE) - k * _PI_LOW
    half = 0.5 * k
    sign = 1.0 - 4.0 * jnp.abs(half - jnp.round(half))  # (-1)^k without integers
    sign = jax.lax.stop_gradient(sign)
    square = r * r
    return sign * (r * _horner(_SINE, square)), sign * _horner(_COSINE, square)


def _horner(coefficients: tuple[float, ...], x: jax.Array) -> jax.Array:
    result = coefficients[-1]
    for c in reversed(coefficients[:-1]):
        result = result * x + c
    return result
