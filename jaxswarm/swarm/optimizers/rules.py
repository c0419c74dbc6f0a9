"""Velocity rules: how a particle at x with memory p and attractor g moves next.

A rule is any function ``(random, swarm, hyper) -> velocity (n, d)``, with ``swarm`` a
:class:`Swarm` and ``hyper`` the coefficients of this step. Most variants of PSO differ only here.

References:
    Y. Shi, R. Eberhart, "A modified particle swarm optimizer", 1998 (inertia weight); J. Kennedy,
    "Bare bones particle swarms", 2003; M. Clerc, "Standard particle swarm optimisation", 2012,
    hal-00764996.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.swarm.lanes import laned
from jaxswarm.swarm.pytree import pytree

__all__ = ["Swarm", "bare_bones", "canonical", "paired", "spherical"]

FEW, ONE_OF = 6, 4
"""Dimensions up to which ``paired`` differs from ``canonical``, and of how many particles one does not."""


class Swarm(NamedTuple):
    """What a velocity rule sees.

    Attributes:
      position, velocity, memory_position, attractor: (n, d).
      value: (n,) of the positions; improved: (n,) bool, whether it beat the particle's memory.
      memory_value: (n,), this step included.
    """

    position: jax.Array
    velocity: jax.Array
    memory_position: jax.Array
    attractor: jax.Array
    value: jax.Array
    improved: jax.Array
    memory_value: jax.Array


def canonical() -> "Canonical":
    """V' = w v + c1 r1 (p - x) + c2 r2 (g - x), with r1, r2 uniform in (0, 1) per coordinate."""
    return Canonical()


def paired() -> "Paired":
    """As ``canonical``, but in up to six dimensions three of four particles draw one pair r1, r2 for all.

    With a pair for every coordinate the axes are special, and a valley across them is crept along; with one
    for all, a swarm moves only in the few directions that its particles span. BBOB's targets reached in 2, 3
    and 5-D with 1,000 evaluations a dimension, and with 10,000, on instances that are not reported:

        canonical               0.677  0.538  0.415      0.871  0.720  0.580
        three of four paired    0.819  0.690  0.460      0.996  0.921  0.669
        all paired              0.832    -    0.464      0.961    -    0.686

    In 8-D canonical is as good or better, in 20-D and 40-D all paired reach half as much. The mixture is ours.
    """
    return Paired()


def bare_bones() -> "BareBones":
    """X' normal around (p + g) / 2 with standard deviation |p - g| in each axis."""
    return BareBones()


def spherical() -> "Spherical":
    """SPSO 2011: draw around the center of gravity G of x, x + c1 (p - x) and x + c2 (g - x).

    v' = w v + G + u R b - x with b uniform on the unit sphere, u uniform in (0, 1) and R = |G - x|:
    no axis is special, so the search does not change when the problem is rotated. A particle that
    is its own attractor leaves the third point out. The published coefficients are c1 = c2 = 1/2 +
    ln 2.
    """
    return Spherical()


def _pulled(swarm_rows, r1, r2, hyper):
    x, v, p, g = swarm_rows
    return hyper["inertia"] * v + hyper["cognitive"] * r1 * (p - x) + hyper["social"] * r2 * (g - x)


@pytree
class Canonical:
    """See :func:`canonical`."""

    def __call__(self, random, swarm, hyper):
        rows = [laned(a) for a in swarm[:4]]  # every coordinate for itself
        r1, r2 = random.uniforms("pulls", 2, rows[0].shape, rows[0].dtype)
        return _pulled(rows, r1, r2, hyper).reshape(swarm.position.shape)


@pytree
class Paired:
    """See :func:`paired`."""

    def __call__(self, random, swarm, hyper):
        x = swarm.position
        count, dims = x.shape
        if not 1 < dims <= FEW:
            return Canonical()(random, swarm, hyper)
        alone = (np.arange(count) % ONE_OF == 0)[:, None]
        own = random.uniforms("pulls", 2, x.shape, x.dtype)
        one = random.uniforms("pairs", 2, (count, 1), x.dtype)
        r1, r2 = (jnp.where(alone, a, b) for a, b in zip(own, one, strict=True))
        return _pulled(swarm[:4], r1, r2, hyper)


@pytree
class BareBones:
    """See :func:`bare_bones`."""

    def __call__(self, random, swarm, hyper):
        noise = random.normal("bare bones", swarm.position.shape, swarm.position.dtype)
        center = 0.5 * (swarm.memory_position + swarm.attractor)
        spread = jnp.abs(swarm.memory_position - swarm.attractor)
        return center + spread * noise - swarm.position


@pytree
class Spherical:
    """See :func:`spherical`."""

    def __call__(self, random, swarm, hyper):
        position, dtype = swarm.position, swarm.position.dtype
        own = hyper["cognitive"] * (swarm.memory_position - position)
        social = hyper["social"] * (swarm.attractor - position)
        alone = jnp.all(swarm.attractor == swarm.memory_position, axis=1, keepdims=True)
        offset = jnp.where(alone, own / 2.0, (own + social) / 3.0)  # G - x
        direction = random.normal("direction", position.shape, dtype)
        direction = direction / jnp.linalg.norm(direction, axis=1, keepdims=True)
        # A particle at rest in its own best place has no offset, and the root no slope there.
        square = jnp.sum(offset**2, axis=1, keepdims=True)
        apart = square > 0.0
        radius = jnp.where(apart, jnp.sqrt(jnp.where(apart, square, 1.0)), 0.0)
        radius = radius * random.uniform("radius", (position.shape[0], 1), dtype)
        return hyper["inertia"] * swarm.velocity + offset + radius * direction
