r"""How a coordinate u of the unit cube becomes a value x: the scales of a space.

    linear       x = lower + u (upper - lower)
    log          x = lower (upper / lower)^u
    integer      x = floor(lower + u (upper - lower + 1)), at most upper: every number as likely
    categorical  the same; x is the index of an option
    unbounded    x = c + h tan(pi (u - 1/2)),  c = (lower + upper) / 2,  h = (upper - lower) / 2

The bounds of an unbounded coordinate say where half of the cube lies: the quarters u = 1/4 and 3/4.
Uniform u make x a Cauchy variable; the tails end at 3e5 h, where u has come to 1e-6 of a wall.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

__all__ = ["COUNTED", "SCALES", "Scale", "to_unit", "to_values"]

EDGE = 1e-6
"""Distance to the walls of the cube at which an unbounded coordinate ends: its values stay finite."""


class Scale(NamedTuple):
    """One scale: both directions, coordinate by coordinate, and what the bounds must be.

    Attributes:
      decode: (u, lower, upper) -> x; encode: (x, lower, upper) -> u.
      fault: (lower, upper), NumPy arrays -> what is wrong with them, or an empty text.
      bounded: whether x lies between lower and upper.
    """

    decode: Callable
    encode: Callable
    fault: Callable = lambda lower, upper: ""
    bounded: bool = True


def _whole(u, lower, upper):
    return jnp.minimum(jnp.floor(lower + u * (upper - lower + 1.0)), upper)


def _cauchy(u, lower, upper):
    center, half = 0.5 * (lower + upper), 0.5 * (upper - lower)
    return center + half * jnp.tan(jnp.pi * (jnp.clip(u, EDGE, 1.0 - EDGE) - 0.5))


def _uncauchy(x, lower, upper):
    return 0.5 + jnp.arctan((2.0 * x - lower - upper) / (upper - lower)) / jnp.pi


def _not_positive(lower, upper):
    if not (lower > 0).all():
        return f"a log scale needs lower > 0, not {lower}"
    with np.errstate(over="ignore"):
        far = not np.isfinite(upper / lower).all()
    return f"in {lower.dtype} a log scale does not reach from {lower} to {upper}" if far else ""


def _not_whole(lower, upper):
    whole = (lower == np.round(lower)).all() and (upper == np.round(upper)).all()
    return "" if whole else f"an integer scale needs whole bounds, not {lower} and {upper}"


_COUNT = Scale(
    _whole, lambda x, lower, upper: (x - lower + 0.5) / (upper - lower + 1.0), _not_whole
)
SCALES = {
    "linear": Scale(
        lambda u, lower, upper: lower + u * (upper - lower),
        lambda x, lower, upper: (x - lower) / (upper - lower),
    ),
    "log": Scale(
        lambda u, lower, upper: lower * jnp.exp(u * jnp.log(upper / lower)),
        lambda x, lower, upper: jnp.log(x / lower) / jnp.log(upper / lower),
        _not_positive,
    ),
    "integer": _COUNT,
    "categorical": _COUNT,
    "unbounded": Scale(_cauchy, _uncauchy, bounded=False),
}
COUNTED = frozenset(name for name, scale in SCALES.items() if scale is _COUNT)
"""Scales whose values are whole numbers."""


def to_values(u: jax.Array, lower: jax.Array, upper: jax.Array, scales: Sequence[str]) -> jax.Array:
    """Decode (d,) coordinates, each on its scale; rounding leaves no bound.

    >>> to_values(jnp.array([0.5, 0.99]), jnp.array([1.0, 1.0]), jnp.array([4.0, 4.0]), ("log", "integer"))
    Array([2., 4.], dtype=float64)
    """
    flat = _each(u, 0.5, lower, upper, scales, "decode")
    bounded = np.array([SCALES[name].bounded for name in scales])
    inside = jnp.clip(flat, lower, upper)
    return inside if bounded.all() else jnp.where(bounded, inside, flat)


def to_unit(x: jax.Array, lower: jax.Array, upper: jax.Array, scales: Sequence[str]) -> jax.Array:
    """Undo :func:`to_values`; a whole number comes to the middle of its share of the cube."""
    return _each(x, 1.0, lower, upper, scales, "encode")


def _each(values, harmless, lower, upper, scales, direction):
    names = sorted(set(scales), key=lambda name: name != "linear")
    out = getattr(SCALES[names[0]], direction)(values, lower, upper) if len(names) == 1 else None
    if out is not None:
        return out
    out = values
    for name in names:
        # Where another scale holds, numbers that no formula minds: their slopes count too.
        own = np.array([scale == name for scale in scales])
        low, high = jnp.where(own, lower, 1.0), jnp.where(own, upper, 2.0)
        formula = getattr(SCALES[name], direction)
        out = jnp.where(own, formula(jnp.where(own, values, harmless), low, high), out)
    return out
