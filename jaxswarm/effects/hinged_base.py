"""An arm whose base turns: the same robot with two hinges below its first joint."""

import jax.numpy as jnp
import numpy as np

from jaxswarm.robot.model import Robot

# Coordinates of the base: turns [rad] about base x and, carried by that, about base y.
TURNS = 2

# Poses over which the inertia of an arm about its base is averaged.
_POSES = 64


def poses(robot: Robot) -> np.ndarray:
    """Poses (m, n) of an arm spread evenly over the turns of its joints, with slides at zero.

    >>> from jaxswarm.robot import emps, rx60
    >>> poses(rx60()).shape, poses(emps()).any()
    ((64, 3), np.False_)
    """
    turns = np.random.default_rng(0).uniform(-np.pi, np.pi, size=(_POSES, robot.num_joints))
    return np.where([kind == "revolute" for kind in robot.kinds], turns, 0.0)


def hinged(robot: Robot) -> Robot:
    """The robot on hinges about base x and y, without mass of their own, through the base's origin.

    >>> from jaxswarm.robot import rx60
    >>> hinged(rx60()).parents
    (-1, 0, 1, 2, 3)
    """
    still = np.broadcast_to(np.eye(3), (TURNS, 3, 3))
    body = robot.parameters
    return robot.replace(
        name="",
        notes=(),
        joints=("turn about base x", "turn about base y", *robot.joints),
        kinds=("revolute",) * TURNS + robot.kinds,
        parents=(-1, 0, *(p + TURNS for p in robot.parents)),
        rotation=_below(still, robot.rotation),
        translation=_below(np.zeros((TURNS, 3)), robot.translation),
        axis=_below(np.eye(3)[:TURNS], robot.axis),
        parameters=_below(np.zeros((TURNS, *body.shape[1:])), body),
        drive_gain=_below(np.full((TURNS, *robot.drive_gain.shape[1:]), np.nan), robot.drive_gain),
    )


def _below(own, above):
    """Rows of the base before those of the arm; known numbers stay known."""
    join = np.concatenate if isinstance(above, np.ndarray) else jnp.concatenate
    return join([own, above])
