"""Poses, velocities and accelerations of the links, from the base outwards.

For joint i with parent p, relative rotation R and origin r of frame i in frame p, axis s, and
everything in the axes of the link it belongs to:

    revolute:   w_i = R^T w_p + s dq,   alpha_i = R^T alpha_p + s ddq + (R^T w_p) x s dq,
                a_i = R^T (a_p + alpha_p x r + w_p x (w_p x r))
    prismatic:  w_i = R^T w_p,          alpha_i = R^T alpha_p,
                a_i = R^T (a_p + alpha_p x r + w_p x (w_p x r)) + s ddq + 2 w_i x s dq

with a the acceleration of the frame's origin less gravity: the base accelerates with -g.

Public functions take one sample, arrays of shape (n,). Arrays of shape (n, num_lanes) also work, as
do link parameters of shape (n, 10, num_lanes): a population then runs through one elementwise
program. Reference: Featherstone 2008, chapter 5; Khalil and Dombre 2002, chapter 9.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.robot import many
from jaxswarm.robot import spatial as sp
from jaxswarm.robot.model import Robot

# Angles are JAX's, or NumPy's along a log.
SinCos = Callable[[Any], tuple[Any, Any]]


class Transform(NamedTuple):
    """Pose of a frame in another one, as entries."""

    rotation: sp.Matrix
    translation: sp.Vector


class LinkMotion(NamedTuple):
    """Motion of one link in its axes, as entries; acceleration is of the origin, less g."""

    angular_velocity: sp.Vector
    angular_acceleration: sp.Vector
    acceleration: sp.Vector


def sincos(angle: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return the sine and cosine of an angle in rad."""
    return sp.settle((jnp.sin(angle), jnp.cos(angle)))


def joint_transforms(robot: Robot, q: sp.ByJoint, sincos: SinCos = sincos) -> list[Transform]:
    """Return for each joint the pose of its link in its parent link's frame.

    Args:
        robot: The robot.
        q: (n,), joint positions in rad or m.
        sincos: Function that gives sine and cosine of an angle.
    """
    # A turn by q about s is s s^T + cos q (1 - s s^T) + sin q [s]x: three constant matrices per
    # joint, with the placement multiplied in, leave two multiply-adds per entry.
    numbers = jnp if isinstance(robot.axis, jax.core.Tracer) else np
    axis, place = robot.axis, robot.rotation
    along = axis[:, :, None] * axis[:, None, :]
    cross = numbers.cross(axis[:, :, None], np.eye(3), axis=1)
    fixed, even, odd = (
        sp.entries((place[:, :, :, None] * part[:, None]).sum(2), 3)
        for part in (along, np.eye(3) - along, cross)
    )
    translations = sp.entries(robot.translation, 2)
    rotations, axes = sp.entries(place, 3), sp.entries(axis, 2)
    transforms = []
    for i, kind in enumerate(robot.kinds):
        if kind == "revolute":
            sine, cosine = sincos(q[i])
            turned = tuple(
                tuple(
                    sp.plus(
                        fixed[i][r][c],
                        sp.plus(sp.times(cosine, even[i][r][c]), sp.times(sine, odd[i][r][c])),
                    )
                    for c in range(3)
                )
                for r in range(3)
            )
            transforms.append(Transform(turned, translations[i]))
        else:
            shift = sp.scale(q[i], sp.rotate(rotations[i], axes[i]))
            transforms.append(Transform(rotations[i], sp.add(translations[i], shift)))
    return transforms


def link_motions(
    robot: Robot,
    transforms: list[Transform],
    dq: sp.ByJoint | None,
    ddq: sp.ByJoint | None,
    *,
    with_gravity: bool = True,
) -> list[LinkMotion]:
    """Return the motion of every link; ``None`` stands for a velocity or acceleration of zero."""
    axes = sp.entries(robot.axis, 2)
    lift = sp.scale(-1.0, sp.entries(robot.gravity, 1)) if with_gravity else sp.ZERO
    base = LinkMotion(sp.ZERO, sp.ZERO, lift)
    motions: list[LinkMotion] = []
    for i, (kind, parent) in enumerate(zip(robot.kinds, robot.parents, strict=True)):
        rotation, translation = transforms[i]
        before = base if parent < 0 else motions[parent]
        speed = sp.ZERO if dq is None else sp.scale(dq[i], axes[i])
        push = sp.ZERO if ddq is None else sp.scale(ddq[i], axes[i])
        carried = sp.rotate_back(rotation, before.angular_velocity)
        turning = sp.rotate_back(rotation, before.angular_acceleration)
        around = sp.cross(before.angular_velocity, sp.cross(before.angular_velocity, translation))
        swing = sp.add(sp.cross(before.angular_acceleration, translation), around)
        acceleration = sp.rotate_back(rotation, sp.add(before.acceleration, swing))
        if kind == "revolute":
            turning = sp.add(turning, sp.add(push, sp.cross(carried, speed)))
            carried = sp.add(carried, speed)
        else:
            coriolis = sp.scale(2.0, sp.cross(carried, speed))
            acceleration = sp.add(acceleration, sp.add(push, coriolis))
        motions.append(sp.settle(LinkMotion(carried, turning, acceleration)))
    return motions


def base_transforms(robot: Robot, transforms: list[Transform]) -> list[Transform]:
    """Return the pose of every link in the base frame."""
    poses: list[Transform] = []
    for parent, (rotation, translation) in zip(robot.parents, transforms, strict=True):
        if parent < 0:
            poses.append(Transform(rotation, translation))
            continue
        carrier = poses[parent]
        origin = sp.add(carrier.translation, sp.rotate(carrier.rotation, translation))
        poses.append(sp.settle(Transform(sp.product(carrier.rotation, rotation), origin)))
    return poses


def forward_kinematics(robot: Robot, q: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return the pose of every link in the base frame.

    Args:
        robot: The robot.
        q: (n,), joint positions in rad or m.

    Returns:
        Rotation (n, 3, 3), link axes to base axes, and position (n, 3) of the link origins in m.

    >>> from jaxswarm.robot.builtin import rx60
    >>> rotation, position = forward_kinematics(rx60(), jnp.zeros(3))
    >>> position[2].round(3).tolist()
    [0.29..., -0.049..., 0.237...]
    """
    q = jnp.asarray(q)
    if many.is_many(robot):
        turned, origin = many.base_transforms(robot, many.transforms(robot, q, sincos), q)
        return jnp.stack([jnp.stack(row, 1) for row in turned], 1), jnp.stack(origin, 1)
    poses = base_transforms(robot, joint_transforms(robot, q))
    rotation = [jnp.stack([sp.stack(row, q[0]) for row in pose.rotation]) for pose in poses]
    position = [sp.stack(pose.translation, q[0]) for pose in poses]
    return jnp.stack(rotation), jnp.stack(position)
