"""Energy and momentum of the links: what motion without effects must conserve."""

import jax
import jax.numpy as jnp

from jaxswarm.robot import spatial as sp
from jaxswarm.robot.kinematics import base_transforms, joint_transforms, link_motions
from jaxswarm.robot.mass import mass_matrix
from jaxswarm.robot.model import Robot


def kinetic_energy(robot: Robot, q: jax.Array, dq: jax.Array) -> jax.Array:
    """Return dq^T M(q) dq / 2 in J, for one sample q, dq (n,).

    >>> from jaxswarm.robot.builtin import rx60
    >>> kinetic_energy(rx60(), jnp.zeros(3), jnp.array([1.0, 0.0, 0.0])).round(5).item()
    4.36725
    """
    dq = jnp.asarray(dq)
    return 0.5 * dq @ mass_matrix(robot, q) @ dq


def potential_energy(robot: Robot, q: jax.Array) -> jax.Array:
    """Return the energy of the links in the field of gravity in J, zero at the base's origin.

    Its gradient in q (n,) is ``gravity_forces(robot, q)``.
    """
    q = jnp.asarray(q)
    gravity = sp.entries(robot.gravity, 1)
    poses = base_transforms(robot, joint_transforms(robot, q))
    energy = 0.0
    for pose, p in zip(poses, sp.entries(robot.parameters, 2), strict=True):
        moment = sp.add(sp.rotate(pose.rotation, p[1:4]), sp.scale(p[0], pose.translation))
        energy = sp.minus(energy, sp.dot(gravity, moment))
    return jnp.asarray(energy, q.dtype)


def momentum(robot: Robot, q: jax.Array, dq: jax.Array) -> jax.Array:
    """Return the spatial momentum of the links in base axes, shape (6,).

    Args:
        robot: The robot.
        q: (n,), joint positions in rad or m.
        dq: (n,), velocities in rad/s or m/s.

    Returns:
        Linear momentum in kg m/s, then angular momentum about the base's origin in kg m^2/s.
    """
    q, dq = jnp.asarray(q), jnp.asarray(dq)
    transforms = joint_transforms(robot, q)
    # Accelerations of a start from rest, with dq for ddq, are the velocities of the links.
    motions = link_motions(robot, transforms, None, dq, with_gravity=False)
    linear, angular = sp.ZERO, sp.ZERO
    poses = base_transforms(robot, transforms)
    parameters = sp.entries(robot.parameters, 2)
    for pose, motion, p in zip(poses, motions, parameters, strict=True):
        w, v = motion.angular_acceleration, motion.acceleration
        push = sp.add(sp.scale(p[0], v), sp.cross(w, p[1:4]))
        turn = sp.add(sp.rotate(sp.symmetric(*p[4:]), w), sp.cross(p[1:4], v))
        push, turn = sp.rotate(pose.rotation, push), sp.rotate(pose.rotation, turn)
        linear = sp.add(linear, push)
        angular = sp.add(angular, sp.add(turn, sp.cross(pose.translation, push)))
    return sp.stack([*linear, *angular], q[0])
