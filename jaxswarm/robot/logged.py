"""Torques and torque columns along a log, in NumPy: nothing is traced, compiled or read from disk.

The recursions of :mod:`jaxswarm.robot.kinematics` and :mod:`jaxswarm.robot.dynamics` take any entries; here
one entry is a whole column of samples, so that a log is a few hundred array operations. For a fit that
evaluates a log some dozen times in a process of its own this beats the compiled program, which first has to
be traced and loaded; where derivatives, batches or devices are wanted use :func:`jaxswarm.robot.regressor`
and :func:`jaxswarm.robot.inverse_dynamics`.
"""

from collections.abc import Iterator

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


def rigid_torques(
    robot: Robot,
    q: np.ndarray,
    dq: np.ndarray,
    ddq: np.ndarray,
    parameters: np.ndarray,
    *,
    first: int = 0,
) -> np.ndarray:
    """Return the torques of every sample for many sets of parameters at once, a signal in one piece each.

    Args:
        robot: The robot; its own parameters do not matter.
        q, dq, ddq: (T, n), motion in rad or m and s.
        parameters: (10 (n - first), m), a set a column.
        first: Links before this one have no mass.

    Returns:
        (n, m, T), in N m or N.

    >>> from jaxswarm.robot.builtin import emps
    >>> rigid_torques(emps(), *np.ones((3, 5, 1)), np.ones((10, 2))).shape
    (1, 2, 5)
    """
    torque = np.zeros((robot.num_joints, parameters.shape[1], len(q)))
    for start in range(0, len(q), BLOCK):
        part = slice(start, start + BLOCK)
        moved = links_along(robot, q[part], dq[part], ddq[part])
        for link, joint, entries in _rows(robot, *moved, first):
            told = [place for place, entry in enumerate(entries) if not sp.is_zero(entry)]
            rows = np.empty((len(told), len(q[part])))
            for row, place in zip(rows, told, strict=True):
                row[:] = entries[place]
            own = parameters[10 * (link - first) :][told]
            torque[joint, :, part] += own.T @ rows
    return torque


def links_along(robot: Robot, q, dq, ddq) -> tuple[list[Transform], list[LinkMotion]]:
    """Poses and motions of all links, an entry for all samples of a motion (T, n)."""
    columns = [
        [_entry(own) for own in np.ascontiguousarray(np.asarray(x, float).T)] for x in (q, dq, ddq)
    ]
    known = {
        name: np.asarray(getattr(robot, name), float)
        for name in ("rotation", "translation", "axis", "gravity")
    }
    robot = robot.replace(**known)
    transforms = joint_transforms(robot, columns[0], lambda angle: (np.sin(angle), np.cos(angle)))
    return transforms, link_motions(robot, transforms, *columns[1:])


def _entry(own: np.ndarray) -> sp.Entry:
    """What a joint does, (T,); a known number where that is the same in all samples: it is folded away."""
    return float(own[0]) if len(own) and (own == own[0]).all() else own


def _fill(
    robot: Robot,
    transforms: list[Transform],
    motions: list[LinkMotion],
    first: int,
    columns: np.ndarray,
) -> None:
    """Write the columns (T, n, 10 (n - first)) of links; those of joints that do not move one stay zero."""
    for link, joint, row in _rows(robot, transforms, motions, first):
        for place, entry in enumerate(row):
            if not sp.is_zero(entry):
                columns[:, joint, 10 * (link - first) + place] = entry


def _rows(
    robot: Robot, transforms: list[Transform], motions: list[LinkMotion], first: int
) -> Iterator[tuple[int, int, list[sp.Entry]]]:
    """Of every link from one on, and of every joint that moves it: both, and ten columns as entries."""
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
            yield link, joint, link_row(motions[link], angular, linear)
