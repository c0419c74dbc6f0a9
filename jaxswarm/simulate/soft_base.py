"""The springs, dampers and inertia of a base that gives way.

The inertia of the base about its axes is what makes the arm swing as often as is told in a pose of mean
inertia (:func:`jaxswarm.effects.hinged_base.poses`); where nothing is told it is a tenth of that mean, for
without any a first joint about the same axis has no hold.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.effects.hinged_base import TURNS, hinged, poses
from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.term import Term
from jaxswarm.robot.mass import equations_of_motion
from jaxswarm.robot.model import Robot

# Compliance [rad/(N m)] below which a base is taken to have this one: firmer costs shorter steps and no more.
FIRM = 1e-7
# Inertia of a base of which no swing is told, and the least that one has, of the arm's mean about it.
BASE_INERTIA, _LEAST = 0.1, 0.01


class Base(NamedTuple):
    """A base on springs about its x and y axes.

    Attributes:
        stiffness: (2,), in N m/rad.
        damping: (2,), in N m s/rad.
        inertia: (2,), of the base itself in kg m^2.
    """

    stiffness: jax.Array
    damping: jax.Array
    inertia: jax.Array


def base_of(robot: Robot, acting: Term) -> Base:
    """Return the base of a robot with a compliance.

    Args:
        robot: What stands on it.
        acting: The compliance with all its values.
    """
    law, values = acting.law_of(BodyChange), acting.values
    assert law.compliance is not None and law.swing is not None
    *often, zeta = law.swing
    most = {p.name: p.upper for p in law.nonlinear}
    soft = jnp.maximum(law.compliance(values), FIRM)
    mean = _mean_inertia(robot)
    whole = []
    for own, c, name in zip(mean, soft, often, strict=True):
        swing = 1.0 / (c * (2.0 * jnp.pi * values[name]) ** 2)
        told = jnp.maximum(swing, (1.0 + _LEAST) * own)
        whole.append(jnp.where(values[name] < most[name], told, (1.0 + BASE_INERTIA) * own))
    inertia = jnp.stack(whole)
    stiffness = jnp.stack([1.0 / c + 0.0 * own for c, own in zip(soft, mean, strict=True)])
    return Base(stiffness, 2.0 * values[zeta] * jnp.sqrt(inertia * stiffness), inertia - mean)


def _mean_inertia(robot: Robot) -> jax.Array:
    """Inertia of an arm about the axes of its base, (2,), over the poses that a swing is told of."""
    arm = hinged(robot)

    def inertia(pose: jax.Array) -> jax.Array:
        q = jnp.concatenate([jnp.zeros(TURNS), pose])
        mass, _ = equations_of_motion(arm, q, jnp.zeros_like(q))
        return jnp.stack([jnp.asarray(mass[k][k]) for k in range(TURNS)])

    return jnp.mean(jax.vmap(inertia)(jnp.asarray(poses(robot))), axis=0)
