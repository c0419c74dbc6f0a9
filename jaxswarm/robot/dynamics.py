"""Joint torques from motion by recursive Newton-Euler.

Forces of link i about its origin, in its axes, with mass m, first moment h and inertia I:

    f_i = m a + alpha x h + w x (w x h),        n_i = I alpha + w x I w + h x a,

summed from the tips to the base; the joint supplies the part along its axis. All arrays are of one
sample; :mod:`jaxswarm.robot.kinematics` explains lanes. References: Luh, Walker, Paul 1980;
Featherstone 2008, chapter 5.
"""

import jax
import jax.numpy as jnp

from jaxswarm.robot import many
from jaxswarm.robot import spatial as sp
from jaxswarm.robot.kinematics import (
    LinkMotion,
    SinCos,
    Transform,
    joint_transforms,
    link_motions,
    sincos,
)
from jaxswarm.robot.model import Robot


def inverse_dynamics(
    robot: Robot, q: jax.Array, dq: jax.Array, ddq: jax.Array, *, sincos: SinCos = sincos
) -> jax.Array:
    """Return the joint torques or forces of a motion, tau = M(q) ddq + h(q, dq).

    Args:
        robot: The robot.
        q: (n,), joint positions in rad or m.
        dq: (n,), velocities in rad/s or m/s.
        ddq: (n,), accelerations in rad/s^2 or m/s^2.
        sincos: Function that gives sine and cosine of an angle.

    Returns:
        (n,), torques in N m or forces in N.

    >>> from jaxswarm.robot.builtin import rx60
    >>> inverse_dynamics(rx60(), jnp.zeros(3), jnp.zeros(3), jnp.ones(3)).shape
    (3,)
    """
    q, dq, ddq = jnp.asarray(q), jnp.asarray(dq), jnp.asarray(ddq)
    return sp.stack(_torques(robot, q, dq, ddq, sincos), q[0])


def gravity_forces(robot: Robot, q: jax.Array, *, sincos: SinCos = sincos) -> jax.Array:
    """Return the torques (n,) that hold the robot at rest at q (n,), in N m or N."""
    q = jnp.asarray(q)
    return sp.stack(_torques(robot, q, None, None, sincos), q[0])


def bias_forces(robot: Robot, q: jax.Array, dq: jax.Array, *, sincos: SinCos = sincos) -> jax.Array:
    """Return h(q, dq): torques (n,) of gravity, Coriolis and centrifugal forces, in N m or N."""
    q, dq = jnp.asarray(q), jnp.asarray(dq)
    return sp.stack(_torques(robot, q, dq, None, sincos), q[0])


def _torques(robot: Robot, q, dq, ddq, sincos: SinCos) -> list[sp.Entry]:
    if many.is_many(robot):
        poses = many.transforms(robot, q, sincos)
        return list(many_torques(robot, poses, q, dq, ddq))
    transforms = joint_transforms(robot, q, sincos)
    motions = link_motions(robot, transforms, dq, ddq)
    return torques_of_motions(robot, transforms, motions)


def many_torques(robot: Robot, poses, q, dq, ddq) -> jax.Array:
    """Return the torques (n, ...) of a robot of many joints from the poses of its links."""
    motion = LinkMotion(*many.link_motions(robot, poses, q, dq, ddq))
    wrenches = link_wrench(many.of_joints(robot.parameters, 1, q), motion)
    return many.torques(robot, poses, sp.settle(wrenches), q)


def torques_of_motions(
    robot: Robot, transforms: list[Transform], motions: list[LinkMotion]
) -> list[sp.Entry]:
    """Return the joint torques that the motions of the links need, as entries."""
    parameters = sp.entries(robot.parameters, 2)
    axes = sp.entries(robot.axis, 2)
    wrenches = [link_wrench(p, m) for p, m in zip(parameters, motions, strict=True)]
    torques: list[sp.Entry] = [0.0] * robot.num_joints
    for i in reversed(range(robot.num_joints)):
        force, moment = sp.settle(wrenches[i])
        torques[i] = sp.dot(axes[i], moment if robot.kinds[i] == "revolute" else force)
        parent = robot.parents[i]
        if parent >= 0:
            rotation, translation = transforms[i]
            force, moment = sp.rotate(rotation, force), sp.rotate(rotation, moment)
            moment = sp.add(moment, sp.cross(translation, force))
            carried = wrenches[parent]
            wrenches[parent] = (sp.add(carried[0], force), sp.add(carried[1], moment))
    return torques


def link_wrench(parameters, motion: LinkMotion) -> tuple[sp.Vector, sp.Vector]:
    """Return force and moment about the link's origin that its motion needs, in its axes."""
    w, alpha, a = motion
    mass, first, inertia = parameters[0], parameters[1:4], sp.symmetric(*parameters[4:])
    force = sp.add(sp.scale(mass, a), sp.cross(alpha, first))
    force = sp.add(force, sp.cross(w, sp.cross(w, first)))
    moment = sp.add(sp.rotate(inertia, alpha), sp.cross(w, sp.rotate(inertia, w)))
    return force, sp.add(moment, sp.cross(first, a))
