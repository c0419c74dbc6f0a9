"""The torque regressor: joint torques are linear in the ten parameters of every link.

A link's wrench is a 6 x 10 matrix times its parameters (m, h, I), h the first moment,

    f = m a + alpha x h + w x (w x h),      n = I alpha + w x I w + h x a.

Instead of carrying six rows of ten numbers down to the base, the axis of every joint is carried up
to the link: the torque of joint j due to link i is (angular part of axis j) . n + (linear part of
axis j at link i) . f, in the axes of link i. All (joint, link) pairs are one array, so that the
program stays short; pairs where the joint does not carry the link are zeroed.

Reference: Atkeson, An, Hollerbach 1986; Khalil and Dombre 2002, chapter 12.
"""

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.robot import many
from jaxswarm.robot import spatial as sp
from jaxswarm.robot.kinematics import (
    LinkMotion,
    SinCos,
    base_transforms,
    joint_transforms,
    link_motions,
    sincos,
)
from jaxswarm.robot.model import Robot


def regressor(
    robot: Robot, q: jax.Array, dq: jax.Array, ddq: jax.Array, *, sincos: SinCos = sincos
) -> jax.Array:
    """Return the (n, 10 n) matrix Y with Y @ robot.parameters.ravel() == inverse_dynamics.

    It does not depend on ``robot.parameters``. Columns follow
    :func:`jaxswarm.robot.standard_parameter_names`.

    Args:
        robot: The robot.
        q: (n,), joint positions in rad or m.
        dq: (n,), velocities in rad/s or m/s.
        ddq: (n,), accelerations in rad/s^2 or m/s^2.
        sincos: Function that gives sine and cosine of an angle.

    >>> from jaxswarm.robot.builtin import emps
    >>> regressor(emps(), jnp.zeros(1), jnp.zeros(1), jnp.array([2.0]))[0, 0].item()
    2.0
    """
    q, dq, ddq = jnp.asarray(q), jnp.asarray(dq), jnp.asarray(ddq)
    n, lanes = robot.num_joints, q.shape[1:]
    rotation, translation, motion = _of_links(robot, q, dq, ddq, sincos)
    axes = sp.rotate(rotation, many.of_joints(robot.axis, 1, q))

    def of_links(entries):
        """Entries of shape (1, n, ...): one number for each link."""
        return jax.tree.map(lambda x: x[None], entries)

    def of_joints(entries):
        """Entries of shape (n, 1, ...): one number for each joint."""
        return jax.tree.map(lambda x: x[:, None], entries)

    def pairs(mask: np.ndarray) -> jax.Array:
        return jnp.asarray(mask, q.dtype).reshape(mask.shape + (1,) * len(lanes))

    turns = many.turning(robot)[:, None]
    carries = many.ancestors(robot)
    axis = of_joints(axes)
    arm = sp.subtract(of_links(translation), of_joints(translation))
    angular = sp.scale(pairs(carries & turns), axis)
    linear = sp.cross(angular, arm)
    if not turns.all():
        linear = sp.add(linear, sp.scale(pairs(carries & ~turns), axis))
    rotation, motion = of_links((rotation, motion))
    row = link_row(motion, sp.rotate_back(rotation, angular), sp.rotate_back(rotation, linear))
    return jnp.stack(row, axis=2).reshape((n, 10 * n, *lanes))


def _of_links(robot: Robot, q, dq, ddq, sincos: SinCos):
    """Return base rotation, base translation and motion of all links as entries (n, ...)."""
    if many.is_many(robot):
        all_poses = many.transforms(robot, q, sincos)
        motion = LinkMotion(*many.link_motions(robot, all_poses, q, dq, ddq))
        return *many.base_transforms(robot, all_poses, q), motion
    transforms = joint_transforms(robot, q, sincos)
    motions = link_motions(robot, transforms, dq, ddq)
    poses = base_transforms(robot, transforms)

    def vector(vectors) -> sp.Vector:
        return tuple(sp.stack(x, q[0]) for x in zip(*vectors, strict=True))

    rotation = tuple(vector(pose.rotation[row] for pose in poses) for row in range(3))
    motion = LinkMotion(*(vector(part) for part in zip(*motions, strict=True)))
    return rotation, vector(pose.translation for pose in poses), motion


def link_row(motion: LinkMotion, angular: sp.Vector, linear: sp.Vector) -> list[sp.Entry]:
    """Return the ten entries of angular . n + linear . f for one link."""
    w, alpha, a = motion
    # x . (alpha x h + w x (w x h)) = h . (x x alpha + (x . w) w - (w . w) x); h x a likewise.
    along, square = sp.dot(linear, w), sp.dot(w, w)
    swing = sp.subtract(sp.scale(along, w), sp.scale(square, linear))
    first = sp.add(sp.add(sp.cross(linear, alpha), swing), sp.cross(a, angular))
    # x . (w x I w) = (x x w) . I w, so both inertia terms are bilinear forms in I.
    turned = sp.cross(angular, w)

    def form(i: int, j: int) -> sp.Entry:
        return sp.plus(sp.times(angular[i], alpha[j]), sp.times(turned[i], w[j]))

    inertia = [
        form(i, j) if i == j else sp.plus(form(i, j), form(j, i))
        for i, j in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))
    ]
    return [sp.dot(linear, a), *first, *inertia]
