"""The robot: a tree of moving joints, each carrying one link of ten inertial parameters.

The frame of link i is the frame of joint i after its motion. At q = 0 it has the pose
(``rotation[i]``, ``translation[i]``) in the frame of link ``parents[i]``; a revolute joint then
turns it by q about ``axis[i]`` and a prismatic one shifts it by q along it. Structure (names,
kinds, parents) is static; every number is a leaf, so a robot can be differentiated, batched and
identified without recompiling. Fixed joints exist only while a robot is built: their links are
lumped into the moving link they sit on, and what is fixed to the base has no dynamics.
"""

import dataclasses
from collections.abc import Sequence

import jax
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.robot.placements import move_parameters, snap

KINDS = ("revolute", "prismatic")
STANDARD_GRAVITY = 9.81  # m/s^2


@jax.tree_util.register_dataclass
@dataclasses.dataclass(frozen=True, eq=False)
class Robot:
    """A tree of n revolute and prismatic joints.

    Attributes:
        name: Name of the robot.
        joints: Names of the moving joints, parents before children.
        kinds: ``"revolute"`` or ``"prismatic"`` for each joint.
        parents: Index of each joint's parent joint, -1 for the base.
        rotation: (n, 3, 3), rotation of each joint frame in its parent's frame at q = 0.
        translation: (n, 3), its origin in m.
        axis: (n, 3), unit axis of motion, in the joint frame.
        gravity: (3,), acceleration of free fall in base axes, in m/s^2.
        parameters: (n, 10), (m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz) of each link in
            kg, kg m, kg m^2, inertia about the origin of the joint frame, in its axes.
        drive_gain: (n,), joint torque or force per unit of measured current or voltage
            (N m/A, N/A, N/V); NaN where none is known.
    """

    name: str = dataclasses.field(metadata={"static": True})
    joints: tuple[str, ...] = dataclasses.field(metadata={"static": True})
    kinds: tuple[str, ...] = dataclasses.field(metadata={"static": True})
    parents: tuple[int, ...] = dataclasses.field(metadata={"static": True})
    rotation: jax.Array
    translation: jax.Array
    axis: jax.Array
    gravity: jax.Array
    parameters: jax.Array
    drive_gain: jax.Array

    @property
    def num_joints(self) -> int:
        """Number of moving joints n."""
        return len(self.joints)

    def replace(self, **changes) -> "Robot":
        """Return a copy with fields replaced, e.g. ``robot.replace(parameters=identified)``."""
        return dataclasses.replace(self, **changes)


@dataclasses.dataclass(frozen=True, eq=False)
class Joint:
    """One joint and the link behind it, as a robot is described before it is built.

    Attributes:
        name: Name of the joint.
        kind: ``"revolute"``, ``"prismatic"`` or ``"fixed"``.
        parent: Name of the parent joint, ``None`` for the base.
        rotation: (3, 3), pose in the parent joint's frame at q = 0.
        translation: (3,), in m.
        axis: (3,), axis of motion in the joint frame; normalized when the robot is built.
        parameters: (10,), inertial parameters of the link, in the joint frame.
    """

    name: str
    kind: str = "revolute"
    parent: str | None = None
    rotation: np.ndarray = dataclasses.field(default_factory=lambda: np.eye(3))
    translation: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(3))
    axis: np.ndarray = dataclasses.field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    parameters: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(10))


def build_robot(
    name: str,
    joints: Sequence[Joint],
    *,
    gravity: Sequence[float] = (0.0, 0.0, -STANDARD_GRAVITY),
    drive_gain: Sequence[float] | None = None,
) -> Robot:
    """Build a robot from joints in any order; fixed joints are lumped into their parents.

    Args:
        name: Name of the robot.
        joints: Joints of one tree, at least one of them moving.
        gravity: (3,), acceleration of free fall in base axes, in m/s^2.
        drive_gain: One number for each moving joint in their resulting order, default NaN.

    Raises:
        InputError: If names repeat, a parent is unknown, the joints form a loop, a kind is unknown,
            an axis is zero, or nothing moves.

    >>> build_robot("arm", [Joint("tip", parent="root"), Joint("root")]).joints
    ('root', 'tip')
    """
    ordered = _parents_first(name, joints)
    moving: list[Joint] = []
    # For every joint seen: the moving joint that carries it (-1: base), and its frame's pose there.
    carrier: dict[str | None, tuple[int, np.ndarray, np.ndarray]] = {
        None: (-1, np.eye(3), np.zeros(3))
    }
    parents, poses, parameters = [], [], []
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
    if not moving:
        raise InputError(f"robot {name!r} has no moving joint: at least one is needed.")
    if drive_gain is None:
        drive_gain = [np.nan] * len(moving)
    elif len(drive_gain) != len(moving):
        raise InputError(
            f"robot {name!r}: drive_gain has {len(drive_gain)} entries for {len(moving)} moving "
            "joints: give one for each."
        )
    return Robot(
        name=name,
        joints=tuple(joint.name for joint in moving),
        kinds=tuple(joint.kind for joint in moving),
        parents=tuple(parents),
        rotation=snap(np.stack([rotation for rotation, _ in poses])),
        translation=np.stack([translation for _, translation in poses]),
        axis=snap(np.stack([_unit_axis(name, joint) for joint in moving])),
        gravity=np.asarray(gravity, dtype=float),
        parameters=np.stack(parameters),
        drive_gain=np.asarray(drive_gain, dtype=float),
    )


def _unit_axis(name: str, joint: Joint) -> np.ndarray:
    axis = np.asarray(joint.axis, dtype=float)
    length = np.linalg.norm(axis)
    if axis.shape != (3,) or not np.isfinite(length) or length == 0.0:
        raise InputError(
            f"robot {name!r}, joint {joint.name!r}: axis {axis.tolist()} is no direction: "
            "three numbers, not all zero, are needed."
        )
    return axis / length


def _parents_first(name: str, joints: Sequence[Joint]) -> list[Joint]:
    """Return the joints with every parent before its children, else in their given order."""
    names = [joint.name for joint in joints]
    for joint in joints:
        if names.count(joint.name) > 1:
            raise InputError(f"robot {name!r}: joint name {joint.name!r} occurs twice: rename one.")
        if joint.kind not in (*KINDS, "fixed"):
            raise InputError(
                f"robot {name!r}, joint {joint.name!r}: kind {joint.kind!r} is not supported: "
                f"use {', '.join(KINDS)} or fixed."
            )
        if joint.parent is not None and joint.parent not in names:
            raise InputError(
                f"robot {name!r}, joint {joint.name!r}: its parent {joint.parent!r} is no joint of "
                "the robot: name a joint, or none for the base."
            )
    ordered: list[Joint] = []
    placed: set[str | None] = {None}
    waiting = list(joints)
    while waiting:
        ready = next((joint for joint in waiting if joint.parent in placed), None)
        if ready is None:
            loop = ", ".join(joint.name for joint in waiting)
            raise InputError(f"robot {name!r}: the joints {loop} form a loop: a tree is needed.")
        waiting.remove(ready)
        ordered.append(ready)
        placed.add(ready.name)
    return ordered
