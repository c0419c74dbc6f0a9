"""Joints that turn the other way, or from another zero, than in the robot's file: another convention.

Makers, simulators and tables of DH numbers disagree on signs and zeros, most by a quarter turn. Nothing is
measured wrongly then: position and torque of such a joint change sign together.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from jaxswarm.identify.checks.guess import OtherRobot
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.samples import Samples
from jaxswarm.identify.checks.sound import Tried
from jaxswarm.robot.model import Robot

CONVENTION = "convention"
# What a joint's change has to gain, as a sum of logarithms, so that others are changed beside it: that of one
# of two quarter turns that are wrong is 0.3 and more.
_WORTH = 0.2


@dataclass(frozen=True)
class Joint:
    """A change of a joint: its sign, then its zero in quarter turns."""

    sign: float = 1.0
    quarters: int = 0

    def then(self, other: "Joint") -> "Joint":
        """Both changes, one after the other."""
        quarters = (int(other.sign) * self.quarters + other.quarters) % 4
        return Joint(self.sign * other.sign, quarters)


_TURNING = [Joint(s, k) for s in (1.0, -1.0) for k in range(4)][1:]
_SLIDING = [Joint(-1.0)]


def convention_guesses(
    robot: Robot, rough: Rough, logged: Tried
) -> Iterator[tuple[OtherRobot, Tried]]:
    """The signs and zeros of joints that leave least, if some leave clearly less than those of the file.

    Joint after joint is changed as long as that gains: all combinations of six are a quarter of a million.

    Args:
        robot: Kinematics.
        rough: Model of the log as it is.
        logged: What that leaves.
    """
    joints, left = (Joint(),) * robot.num_joints, logged
    while True:
        tried = [
            (_left(robot, rough, one), one)
            for j, kind in enumerate(robot.kinds)
            for change in (_TURNING if kind == "revolute" else _SLIDING)
            for one in [(*joints[:j], joints[j].then(change), *joints[j + 1 :])]
        ]
        low, best = min(tried, key=lambda pair: pair[0].power)
        if low.power > left.power - _WORTH:
            break
        joints, left = best, low
    if left is not logged:
        yield _guess(robot, joints), left


def _changed(samples: Samples, joints: tuple[Joint, ...]) -> Samples:
    """The log as it would be in the file's convention."""
    quarters = np.array([j.quarters for j in joints])
    return samples.turned(np.array([j.sign for j in joints]), 0.5 * np.pi * quarters)


def _left(robot: Robot, rough: Rough, joints: tuple[Joint, ...]) -> Tried:
    return Rough(robot, _changed(rough.samples, joints)).as_logged()[0]


def _guess(robot: Robot, joints: tuple[Joint, ...]) -> OtherRobot:
    wrong = tuple(i for i, joint in enumerate(joints) if joint != Joint())
    told = [f"{robot.joints[i]} = {_in_words(joints[i])}" for i in wrong]
    return OtherRobot(
        CONVENTION,
        f"joints have other signs or zeros in the log than in the robot's file, where {', '.join(told)}",
        wrong,
        motion=lambda samples: _changed(samples, joints),
        remedy="Change these joints in the file, or position and torque in the log",
    )


def _in_words(joint: Joint) -> str:
    """A joint's position in the file by the one in the log [rad].

    >>> _in_words(Joint(-1.0, 3)), _in_words(Joint(1.0, 2))
    ('-logged - 1.571', 'logged + 3.142')
    """
    zero = {0: "", 1: " + 1.571", 2: " + 3.142", 3: " - 1.571"}[joint.quarters]
    return f"{'-' if joint.sign < 0 else ''}logged{zero}"
