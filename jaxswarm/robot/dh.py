"""Denavit-Hartenberg tables, in the two conventions that differ and are often confused.

- modified (Craig, Khalil):  T_j = Rx(alpha_j) Tx(a_j) Rz(theta_j + q_j) Tz(d_j); joint j turns
  about z of frame j, which moves with it.
- standard (Paul, Spong):    A_j = Rz(theta_j + q_j) Tz(d_j) Tx(a_j) Rx(alpha_j); joint j turns
  about z of frame j-1.

A prismatic joint adds q to d instead of theta. Link frames here always are joint frames after their
motion: in the standard convention that is frame j-1 turned by q_j, not frame j, so the last row's
d, a and alpha only place the tool.

References: J. J. Craig, Introduction to Robotics, 2005, section 3.4 (modified); M. W. Spong,
S. Hutchinson, M. Vidyasagar, Robot Modeling and Control, 2006, section 3.2 (standard).
"""

from collections.abc import Sequence

import numpy as np

from jaxswarm.errors import InputError, nearest
from jaxswarm.robot.build import build_robot
from jaxswarm.robot.joints import STANDARD_GRAVITY, Joint
from jaxswarm.robot.model import Robot
from jaxswarm.robot.placements import rotation_x, rotation_z

CONVENTIONS = ("modified", "standard")


def robot_from_dh(
    name: str,
    *,
    convention: str,
    alpha: Sequence[float],
    a: Sequence[float],
    d: Sequence[float],
    theta: Sequence[float] | None = None,
    kinds: Sequence[str] | None = None,
    joints: Sequence[str] | None = None,
    base_rotation: np.ndarray | None = None,
    parameters: np.ndarray | None = None,
    gravity: Sequence[float] | np.ndarray = (0.0, 0.0, -STANDARD_GRAVITY),
    drive_gain: Sequence[float] | np.ndarray | None = None,
) -> Robot:
    """Build a serial arm from a Denavit-Hartenberg table of n rows.

    Args:
        name: Name of the robot.
        convention: ``"modified"`` or ``"standard"``.
        alpha: (n,), twist angles in rad.
        a: (n,), link lengths in m.
        d: (n,), link offsets in m.
        theta: (n,), joint angle at q = 0 in rad, default zeros.
        kinds: (n,), ``"revolute"`` (default) or ``"prismatic"``.
        joints: (n,), names, default ``joint1, joint2, ...``.
        base_rotation: (3, 3), rotation of the table's frame 0 in base axes, default the identity.
        parameters: (n, 10), link parameters in the joint frames, default zeros.
        gravity: (3,), in base axes, in m/s^2.
        drive_gain: (n,), default NaN.

    Raises:
        InputError: If the convention is unknown or the columns differ in length.

    >>> arm = robot_from_dh("arm", convention="modified", alpha=[0, 0], a=[0, 0.5], d=[0, 0])
    >>> arm.joints, arm.translation.tolist()
    (('joint1', 'joint2'), [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]])
    """
    if convention not in CONVENTIONS:
        raise InputError(
            f"robot {name!r}: unknown Denavit-Hartenberg convention {convention!r}. "
            + nearest(str(convention), CONVENTIONS)
        )
    n = len(alpha)
    columns = {
        "alpha": alpha,
        "a": a,
        "d": d,
        "theta": [0.0] * n if theta is None else theta,
        "kinds": ["revolute"] * n if kinds is None else kinds,
        "joints": [f"joint{j + 1}" for j in range(n)] if joints is None else joints,
        "parameters": np.zeros((n, 10)) if parameters is None else parameters,
    }
    rows = _rows(name, convention, columns, base_rotation)
    return build_robot(name, rows, gravity=gravity, drive_gain=drive_gain)


def _rows(
    name: str, convention: str, columns: dict, base_rotation: np.ndarray | None
) -> list[Joint]:
    """The joints of a table whose columns have one entry for each."""
    n = len(columns["alpha"])
    for column, values in columns.items():
        if len(values) != n:
            raise InputError(
                f"robot {name!r}: column {column} of the Denavit-Hartenberg table has "
                f"{len(values)} entries, alpha has {n}: give one for each joint."
            )
    place = _modified_placements if convention == "modified" else _standard_placements
    poses = place(columns["alpha"], columns["a"], columns["d"], columns["theta"])
    if base_rotation is not None:
        rotation, translation = poses[0]
        poses[0] = (base_rotation @ rotation, base_rotation @ translation)
    names = columns["joints"]
    return [
        Joint(
            name=names[j],
            kind=columns["kinds"][j],
            parent=names[j - 1] if j else None,
            rotation=poses[j][0],
            translation=poses[j][1],
            parameters=columns["parameters"][j],
        )
        for j in range(n)
    ]


Pose = tuple[np.ndarray, np.ndarray]


def _modified_placements(alpha, a, d, theta) -> list[Pose]:
    """Return Rx(alpha) Tx(a) Rz(theta) Tz(d) for each joint."""
    poses = []
    for twist, length, offset, angle in zip(alpha, a, d, theta, strict=True):
        turn = rotation_x(twist)
        poses.append((turn @ rotation_z(angle), np.array([length, 0, 0]) + offset * turn[:, 2]))
    return poses


def _standard_placements(alpha, a, d, theta) -> list[Pose]:
    """Return Tz(d) Tx(a) Rx(alpha) of the row before, then Rz(theta), for each joint."""
    poses, before = [], (np.eye(3), np.zeros(3))
    for twist, length, offset, angle in zip(alpha, a, d, theta, strict=True):
        poses.append((before[0] @ rotation_z(angle), before[1]))
        before = (rotation_x(twist), np.array([length, 0.0, offset]))
    return poses
