"""From joints in any order to the arrays of a robot: ordered, checked, fixed joints lumped."""

import heapq
from collections.abc import Sequence
from typing import Any

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.robot.checks import check_name, check_numbers, shown, unit_axis
from jaxswarm.robot.joints import DOWN, Description, Joint
from jaxswarm.robot.model import KINDS, Robot
from jaxswarm.robot.placements import move_parameters, snap


def build_robot(
    name: str,
    joints: Sequence[Joint],
    *,
    gravity: Sequence[float] | np.ndarray = DOWN,
    drive_gain: Sequence[float] | np.ndarray | None = None,
) -> Robot:
    """Build a robot from joints in any order; fixed joints are lumped into their parents.

    Args:
        name: Name of the robot.
        joints: Joints of one tree, at least one of them moving.
        gravity: (3,), acceleration of free fall in base axes, in m/s^2.
        drive_gain: One number for each moving joint in their resulting order, default NaN.

    Raises:
        InputError: If names repeat, a parent is unknown, the joints form a loop, a kind is unknown,
            an axis is zero, a number is not finite, a mass is negative, or nothing moves.

    >>> build_robot("arm", [Joint("tip", parent="root"), Joint("root")]).joints
    ('root', 'tip')
    """
    ordered = parents_first(name, joints)
    for joint in ordered:
        _check_joint(f"robot {name!r}, joint {joint.name!r}", joint)
    check_numbers(f"robot {name!r}", "gravity", gravity, (3,))
    moving, parents, poses, parameters = _lumped(ordered)
    if not moving:
        raise InputError(f"robot {name!r} has no moving joint: at least one is needed.")
    if drive_gain is None:
        drive_gain = [np.nan] * len(moving)
    elif len(drive_gain) != len(moving):
        raise InputError(
            f"robot {name!r}: drive_gain has {len(drive_gain)} entries for {len(moving)} moving "
            "joints: give one for each."
        )
    # Arrays of NumPy, whose numbers are known when a program is traced.
    known: dict[str, Any] = {
        "rotation": snap(np.stack([rotation for rotation, _ in poses])),
        "translation": np.stack([translation for _, translation in poses]),
        "axis": snap(np.stack([unit_axis(joint.name, joint.axis) for joint in moving])),
        "gravity": np.asarray(gravity, dtype=float),
        "parameters": np.stack(parameters),
        "drive_gain": np.asarray(drive_gain, dtype=float),
    }
    return Robot(
        name=name,
        joints=tuple(joint.name for joint in moving),
        kinds=tuple(joint.kind for joint in moving),
        parents=tuple(parents),
        **known,
    )


def _lumped(ordered: Sequence[Joint]) -> tuple[list[Joint], list[int], list[tuple], list]:
    """Moving joints, parents before children, with parents, poses in them and link parameters (10,).

    What hangs on a fixed joint belongs to the moving joint that carries it.
    """
    moving: list[Joint] = []
    # For every joint seen: the moving joint that carries it (-1: base), and its frame's pose there.
    carrier: dict[str | None, tuple[int, np.ndarray, np.ndarray]] = {
        None: (-1, np.eye(3), np.zeros(3))
    }
    parents: list[int] = []
    poses: list[tuple] = []
    parameters: list[np.ndarray] = []
    for joint in ordered:
        index, rotation, translation = carrier[joint.parent]
        translation = rotation @ np.asarray(joint.translation, dtype=float) + translation
        rotation = rotation @ np.asarray(joint.rotation, dtype=float)
        if joint.kind == "fixed":
            carrier[joint.name] = (index, rotation, translation)
            if index >= 0:
                parameters[index] += move_parameters(joint.parameters, rotation, translation)
            continue
        carrier[joint.name] = (len(moving), np.eye(3), np.zeros(3))
        moving.append(joint)
        parents.append(index)
        poses.append((rotation, translation))
        parameters.append(np.array(joint.parameters, dtype=float))
    return moving, parents, poses, parameters


def build_description(description: Description) -> Robot:
    """Build the robot of a description, its notes and drive gains with it."""
    robot = build_robot(description.name, description.joints, gravity=description.gravity)
    gains = [description.drive_gain.get(joint, np.nan) for joint in robot.joints]
    return robot.replace(drive_gain=np.array(gains), notes=description.notes)


def description_of(robot: Robot) -> Description:
    """Return a built robot as joints again."""
    rotation, translation, axis, parameters = (
        np.asarray(x, dtype=float)
        for x in (robot.rotation, robot.translation, robot.axis, robot.parameters)
    )
    joints = tuple(
        Joint(
            name=name,
            kind=robot.kinds[i],
            parent=None if robot.parents[i] < 0 else robot.joints[robot.parents[i]],
            rotation=rotation[i],
            translation=translation[i],
            axis=axis[i],
            parameters=parameters[i],
        )
        for i, name in enumerate(robot.joints)
    )
    gains = dict(zip(robot.joints, np.asarray(robot.drive_gain).tolist(), strict=True))
    gravity = tuple(np.asarray(robot.gravity).tolist())
    return Description(robot.name, joints, gravity, gains, robot.notes)


def _check_joint(place: str, joint: Joint) -> None:
    if joint.kind not in (*KINDS, "fixed"):
        raise InputError(
            f"{place}: kind {joint.kind!r} is not supported: use {', '.join(KINDS)} or fixed, or "
            f"hold it where the file places it: --lock {joint.name}"
        )
    check_numbers(place, "rotation", joint.rotation, (3, 3))
    check_numbers(place, "translation", joint.translation, (3,))
    check_numbers(place, "parameters", joint.parameters, (10,))
    mass = float(joint.parameters[0])
    if mass < 0.0:
        raise InputError(f"{place}: mass {mass:g} kg is below zero: give the mass of the link.")
    if joint.kind == "fixed":
        return
    unit_axis(place, joint.axis)


def parents_first(name: str, joints: Sequence[Joint]) -> list[Joint]:
    """Return the joints with every parent before its children, else in their given order.

    Raises:
        InputError: If names are missing or repeat, a parent is unknown, or the joints form a loop.
    """
    known: set[str] = set()
    for k, joint in enumerate(joints):
        check_name(f"robot {name!r}: joint number {k + 1}", joint.name)
        if joint.name in known:
            raise InputError(
                f"robot {name!r}: joint name {shown(joint.name)} occurs twice: rename one."
            )
        known.add(joint.name)
    children: dict[str | None, list[int]] = {}
    for k, joint in enumerate(joints):
        if joint.parent is not None and joint.parent not in known:
            raise InputError(
                f"robot {name!r}, joint {joint.name!r}: its parent {shown(joint.parent)} is no joint of "
                "the robot: name a joint, or none for the base."
            )
        children.setdefault(joint.parent, []).append(k)
    ordered: list[Joint] = []
    ready = list(children.get(None, ()))  # a heap: the first in the given order comes first
    while ready:
        joint = joints[heapq.heappop(ready)]
        ordered.append(joint)
        for k in children.get(joint.name, ()):
            heapq.heappush(ready, k)
    if len(ordered) < len(joints):
        placed = {joint.name for joint in ordered}
        left = [joint.name for joint in joints if joint.name not in placed]
        more = f" and {len(left) - 10} more" if len(left) > 10 else ""
        raise InputError(
            f"robot {name!r}: the joints {', '.join(left[:10])}{more} form a loop: a tree is needed."
        )
    return ordered
