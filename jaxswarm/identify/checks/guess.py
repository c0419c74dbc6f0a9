"""What a guess about a log is: one way in which it, or the robot declared for it, may be wrong."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jaxswarm.identify.checks.samples import Samples
from jaxswarm.robot.model import Robot


@dataclass(frozen=True)
class Guess:
    """One way in which a log may be wrong.

    Attributes:
        check: Name of the check it belongs to.
        what: The guess in words.
        joints: Joints it changes.
        mixture: Row j says which logged torques are joint j's, (n, n); None: as logged.
        motion: The log it would be; None: as logged.
        remedy: What to do.
        needed: What it has to gain, as a sum of logarithms; None: what its check asks for.
        told_only: Whether the log is fitted as it is.
    """

    check: str
    what: str
    joints: tuple[int, ...]
    mixture: np.ndarray | None = None
    motion: Callable[[Samples], Samples] | None = None
    remedy: str = "Mend these columns of the log"
    needed: float | None = None
    told_only: bool = False

    @property
    def changes(self) -> int:
        """How many things would be wrong: that with fewer is likelier."""
        return len(self.joints)

    def moved(self, samples: Samples) -> Samples:
        """The log as it would be with the guess's motion."""
        return samples if self.motion is None else self.motion(samples)


@dataclass(frozen=True, kw_only=True)
class Scale(Guess):
    """A number that is a multiple of what is logged.

    Attributes:
        factor: How many times.
        nearby: The same guess with so many times its factor.
    """

    factor: float
    nearby: Callable[[float], "Scale"]


@dataclass(frozen=True, kw_only=True)
class Zero(Guess):
    """A position that reads too large by a constant.

    Attributes:
        sizable: Whether it is larger than those that springs, cables and tilts look like.
    """

    sizable: bool


@dataclass(frozen=True, kw_only=True)
class OtherRobot(Guess):
    """Nothing is wrong with the log, but with the robot it is declared of.

    Attributes:
        arm: The robot it would be a log of; None: the one declared, with joints as ``motion`` changes them.
    """

    arm: Robot | None = None

    @property
    def changes(self) -> int:
        """How many things would be wrong."""
        return 1 if self.arm is not None else len(self.joints)


def times(factor: float) -> str:
    """A factor in words."""
    if factor in (0.5, 2.0):
        return "half" if factor == 0.5 else "twice"
    return f"{float(f'{factor:.2g}'):g} times"


def named(robot: Robot, joints: tuple[int, ...]) -> str:
    """Names of joints in a sentence."""
    names = [robot.joints[j] for j in joints]
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
