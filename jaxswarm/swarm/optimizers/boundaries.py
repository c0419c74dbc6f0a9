"""What happens to a particle that leaves the unit cube.

A boundary is any function ``(random, position, velocity) -> (position, velocity)``, arrays (n, d):
the returned positions lie in [0, 1], and coordinates inside are untouched.

Reference:
    S. Helwig, J. Branke, S. Mostaghim, "Experimental analysis of bound handling techniques in
    particle swarm optimization", IEEE Trans. Evol. Comput. 17 (2013), doi
    10.1109/TEVC.2012.2189404.
"""

import jax
import jax.numpy as jnp

from jaxswarm.swarm.pytree import pytree
from jaxswarm.swarm.schedules import coefficient

__all__ = ["absorb", "bounce", "clip", "periodic", "reflect", "resample"]


def clip() -> "Clip":
    """Stop at the wall and keep the velocity."""
    return Clip()


def absorb() -> "Absorb":
    """Stop at the wall and lose the velocity across it."""
    return Absorb()


def reflect(damping: float = 0.5) -> "Reflect":
    """Bounce off the walls; the velocity turns round and keeps the share ``damping`` (0 to 1)."""
    return Reflect(coefficient("damping", damping, lower=0.0, upper=1.0))


def bounce(damping: float = 0.5) -> "Bounce":
    """Stop at the wall and turn the velocity round, keeping the share ``damping`` (SPSO 2011)."""
    return Bounce(coefficient("damping", damping, lower=0.0, upper=1.0))


def periodic() -> "Periodic":
    """Re-enter at the opposite wall with the same velocity."""
    return Periodic()


def resample() -> "Resample":
    """Draw a coordinate that left the cube anew, at rest."""
    return Resample()


@pytree
class Clip:
    """See :func:`clip`."""

    def __call__(self, random, position, velocity):
        return jnp.clip(position, 0.0, 1.0), velocity


@pytree
class Absorb:
    """See :func:`absorb`."""

    def __call__(self, random, position, velocity):
        inside = jnp.clip(position, 0.0, 1.0)
        return inside, jnp.where(inside == position, velocity, 0.0)


@pytree
class Reflect:
    """See :func:`reflect`."""

    damping: float

    def __call__(self, random, position, velocity):
        damping = jnp.asarray(self.damping, velocity.dtype)
        # Distance to the nearest even number: the position itself where it is inside.
        even = 2.0 * jax.lax.round(0.5 * position, jax.lax.RoundingMethod.TO_NEAREST_EVEN)
        folded = jnp.abs(position - even)
        turned = jnp.where(position < even, -damping, damping) * velocity
        return folded, jnp.where(folded == position, velocity, turned)


@pytree
class Bounce:
    """See :func:`bounce`."""

    damping: float

    def __call__(self, random, position, velocity):
        inside = jnp.clip(position, 0.0, 1.0)
        turned = -jnp.asarray(self.damping, velocity.dtype) * velocity
        return inside, jnp.where(inside == position, velocity, turned)


@pytree
class Periodic:
    """See :func:`periodic`."""

    def __call__(self, random, position, velocity):
        outside = (position < 0.0) | (position > 1.0)
        return jnp.where(outside, position - jnp.floor(position), position), velocity


@pytree
class Resample:
    """See :func:`resample`."""

    def __call__(self, random, position, velocity):
        outside = (position < 0.0) | (position > 1.0)
        fresh = random.uniform("boundary", position.shape, position.dtype)
        return jnp.where(outside, fresh, position), jnp.where(outside, 0.0, velocity)
