"""A joint that sits elsewhere on its parent than the model says."""

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.programs import program
from jaxswarm.robot.model import Robot

# Axes that enclose less than this [sine] are taken as parallel.
_PARALLEL = 1e-6


def across(robot: Robot, joint: int) -> np.ndarray:
    """Two unit directions across a joint's axis in its parent's frame, (2, 3).

    The first lies across the parent's axis too: turns about that one are told as its wrong zero.
    """
    axis = np.asarray(robot.rotation[joint]) @ np.asarray(robot.axis[joint])
    parent = robot.parents[joint]
    before = np.asarray(robot.axis[parent]) if parent >= 0 else axis
    first = np.cross(before, axis)
    if np.linalg.norm(first) < _PARALLEL:
        first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first = first / np.linalg.norm(first)
    return np.stack([first, np.cross(axis, first)])


def own_moves(robot: Robot, joint: int) -> np.ndarray:
    """Ones where a move is told as the joint's own, (2, 2): a turn about its parent's axis is not."""
    axis = np.asarray(robot.axis[robot.parents[joint]])
    own = np.asarray(robot.rotation[joint]) @ np.asarray(robot.axis[joint])
    told = np.ones((2, 2))
    told[1, 1] = np.linalg.norm(np.cross(axis, own)) < _PARALLEL
    return told


def moved_joint(robot: Robot, joint: int, moves: jax.Array) -> Robot:
    """The robot whose joint is shifted and turned on its parent.

    Args:
        robot: The robot.
        joint: Index of the joint.
        moves: (2, 2): shifts [m] along the directions of :func:`across`, and turns [rad] about them.
    """
    placed = _placed(robot.translation, robot.rotation, joint, across(robot, joint), moves)
    return robot.replace(translation=placed[0], rotation=placed[1])


@program()
def _placed(translation, rotation, joint, directions, moves) -> tuple[jax.Array, jax.Array]:
    """Translations (n, 3) and rotations (n, 3, 3) with one of them shifted and turned."""
    shift, turn = moves[0] @ directions, moves[1] @ directions
    size = jnp.sqrt(jnp.sum(turn**2) + 1e-30)
    cross = jnp.cross(turn[:, None] / size, jnp.eye(3), axis=0)
    turned = jnp.eye(3) + jnp.sin(size) * cross + (1.0 - jnp.cos(size)) * cross @ cross
    own = turned @ jnp.asarray(rotation)[joint]
    moved = jnp.asarray(translation).at[joint].add(shift)
    return moved, jnp.asarray(rotation).at[joint].set(own)
