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

from jaxswarm.swarm.lanes import laned
from jaxswarm.swarm.pytree import pytree

__all__ = ["Swarm", "bare_bones", "canonical", "spherical"]


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


@pytree
class Canonical:
    """See :func:`canonical`."""

    def __call__(self, random, swarm, hyper):
        x, v, p, g = map(laned, swarm[:4])  # every coordinate for itself
        r1, r2 = random.uniforms("pulls", 2, x.shape, x.dtype)
        v = (
            hyper["inertia"] * v
            + hyper["cognitive"] * r1 * (p - x)
            + hyper["social"] * r2 * (g - x)
        )
        return v.reshape(swarm.position.shape)


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
