"""Torques and torque columns along a log, in NumPy: nothing is traced, compiled or read from disk.

The recursions of :mod:`jaxswarm.robot.kinematics` and :mod:`jaxswarm.robot.dynamics` take any entries; here
one entry is a whole column of samples, so that a log is a few hundred array operations. For a fit that
evaluates a log some dozen times in a process of its own this beats the compiled program, which first has to
be traced and loaded; where derivatives, batches or devices are wanted use :func:`jaxswarm.robot.regressor`
and :func:`jaxswarm.robot.inverse_dynamics`.
"""

import numpy as np

from jaxswarm.robot import spatial as sp
from jaxswarm.robot.dynamics import torques_of_motions
from jaxswarm.robot.kinematics import LinkMotion, Transform, joint_transforms, link_motions
from jaxswarm.robot.model import Robot
from jaxswarm.robot.regressor import link_row

# Samples that pass at a time: the hundreds of entries in between stay in the cache.
BLOCK = 8192


def rigid_columns(
    robot: Robot, q: np.ndarray, dq: np.ndarray, ddq: np.ndarray, *, first: int = 0
) -> np.ndarray:
    """Return the torque columns of every sample, the regressors of :func:`jaxswarm.robot.regressor`.

    Args:
        robot: The robot; its parameters do not matter.
        q: (T, n), joint positions in rad or m.
        dq: (T, n), velocities in rad/s or m/s.
        ddq: (T, n), accelerations in rad/s^2 or m/s^2.
        first: Links before this one are left out.

    Returns:
        (T, n, 10 (n - first)).

    >>> from jaxswarm.robot.builtin import emps
    >>> rigid_columns(emps(), np.zeros((5, 1)), np.zeros((5, 1)), np.full((5, 1), 2.0))[4, 0, 0].item()
    2.0
    """
    columns = np.zeros((*q.shape, 10 * (robot.num_joints - first)))
    for start in range(0, len(q), BLOCK):
        part = slice(start, start + BLOCK)
        transforms, motions = links_along(robot, q[part], dq[part], ddq[part])
        _fill(robot, transforms, motions, first, columns[part])
    return columns


def rigid_torque(robot: Robot, q: np.ndarray, dq: np.ndarray, ddq: np.ndarray) -> np.ndarray:
    """Return the torques (T, n) of every sample, those of :func:`jaxswarm.robot.inverse_dynamics`.

    The robot's numbers may belong to one robot, or to every sample: parameters (n, 10, T).

    >>> from jaxswarm.robot.builtin import emps, rx60
    >>> rigid_torque(rx60(), *np.zeros((3, 5, 3))).shape
    (5, 3)
    """
    torque = np.empty(q.shape)
    known = np.asarray(robot.parameters, float)
    robot = robot.replace(parameters=known)
    for start in range(0, len(q), BLOCK):
        part = slice(start, start + BLOCK)
        own = robot if known.ndim == 2 else robot.replace(parameters=known[..., part])
        moved = links_along(own, q[part], dq[part], ddq[part])
        for joint, entry in enumerate(torques_of_motions(own, *moved)):
            torque[part, joint] = entry
    return torque


def links_along(robot: Robot, q, dq, ddq) -> tuple[list[Transform], list[LinkMotion]]:
    """Poses and motions of all links, an entry for all samples of a motion (T, n)."""
    columns = [np.ascontiguousarray(np.asarray(x, float).T) for x in (q, dq, ddq)]
    known = {
        name: np.asarray(getattr(robot, name), float)
        for name in ("rotation", "translation", "axis", "gravity")
    }
    robot = robot.replace(**known)
    transforms = joint_transforms(robot, columns[0], lambda angle: (np.sin(angle), np.cos(angle)))
    return transforms, link_motions(robot, transforms, *columns[1:])


def _fill(
    robot: Robot,
    transforms: list[Transform],
    motions: list[LinkMotion],
    first: int,
    columns: np.ndarray,
) -> None:
    """Write the columns (T, n, 10 (n - first)) of links; those of joints that do not move one stay zero."""
    axes = sp.entries(np.asarray(robot.axis, float), 2)
    # Of every link the axes that move it, in its own frame: joint, angular and linear part.
    carried: list[list[tuple[int, sp.Vector, sp.Vector]]] = []
    for link, (kind, parent) in enumerate(zip(robot.kinds, robot.parents, strict=True)):
        rotation, translation = transforms[link]
        moved = []
        for joint, angular, linear in carried[parent] if parent >= 0 else ():
            linear = sp.add(linear, sp.cross(angular, translation))
            moved.append(
                (joint, sp.rotate_back(rotation, angular), sp.rotate_back(rotation, linear))
            )
        own = (axes[link], sp.ZERO) if kind == "revolute" else (sp.ZERO, axes[link])
        moved.append((link, *own))
        carried.append(moved)
        if link < first:
            continue
        for joint, angular, linear in moved:
            for place, entry in enumerate(link_row(motions[link], angular, linear)):
                if not sp.is_zero(entry):
                    columns[:, joint, 10 * (link - first) + place] = entry
