"""A robot as it is described before it is built: joints by name, in any order, each with its link."""

import dataclasses
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

STANDARD_GRAVITY = 9.81  # m/s^2
DOWN = (0.0, 0.0, -STANDARD_GRAVITY)


class Limits(NamedTuple):
    """What a joint may do: positions in rad or m, velocity and effort; NaN where not known."""

    lower: float = np.nan
    upper: float = np.nan
    velocity: float = np.nan
    effort: float = np.nan


class Mimic(NamedTuple):
    """Coupling of a joint to another one: q = multiplier q_joint + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


class Capsule(NamedTuple):
    """A segment from start to end with a radius around it, in m."""

    start: np.ndarray
    end: np.ndarray
    radius: float


@dataclasses.dataclass(frozen=True, eq=False)
class Joint:
    """One joint and the link behind it.

    Attributes:
        name: Name of the joint.
        kind: ``"revolute"``, ``"prismatic"`` or ``"fixed"``; a description may hold others, which
            have to be locked before a robot is built.
        parent: Name of the parent joint, ``None`` for the base.
        rotation: (3, 3), pose in the parent joint's frame at q = 0.
        translation: (3,), in m.
        axis: (3,), axis of motion in the joint frame; normalized when the robot is built.
        parameters: (10,), inertial parameters of the link, in the joint frame.
        limits: Limits of the motion.
        mimic: Coupling to another joint, if there is one.
        shapes: What the link fills, in the joint frame; empty where the file does not tell.
    """

    name: str
    kind: str = "revolute"
    parent: str | None = None
    rotation: np.ndarray = dataclasses.field(default_factory=lambda: np.eye(3))
    translation: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(3))
    axis: np.ndarray = dataclasses.field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    parameters: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(10))
    limits: Limits = Limits()
    mimic: Mimic | None = None
    shapes: tuple[Capsule, ...] = ()


@dataclasses.dataclass(frozen=True, eq=False)
class Description:
    """What a robot file says.

    Attributes:
        name: Name of the robot.
        joints: Joints of one tree, those that never move among them.
        gravity: Acceleration of free fall in base axes, in m/s^2.
        drive_gain: Joint -> torque or force per unit of current or voltage, where known.
        notes: What the file holds that was not read, and what was locked or added.
        base_shapes: What the base fills, in its frame.
    """

    name: str
    joints: tuple[Joint, ...]
    gravity: tuple[float, ...] = DOWN
    drive_gain: Mapping[str, float] = dataclasses.field(default_factory=dict)
    notes: tuple[str, ...] = ()
    base_shapes: tuple[Capsule, ...] = ()
