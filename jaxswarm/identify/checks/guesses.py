"""What a log might be instead: other signs, scales or clocks, channels exchanged; each as a changed log."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import combinations, permutations, product

import numpy as np

from jaxswarm.identify.checks.samples import Samples
from jaxswarm.robot.model import Robot

# Joints up to which every order of the torques and every pattern of signs is tried.
_ALL_ORDERS, _ALL_SIGNS = 4, 8
# Wrong scales: ratios of gears and units, and of a reading that is taken once for twice.
_TORQUE_FACTORS = (1e-3, 0.01, 0.1, 0.5, 2.0, 10.0, 100.0, 1e3)
_MOTION_FACTORS = (0.5, 2.0)
_DEGREE = np.pi / 180.0
ENCODER_ZERO = "encoder_zero"
# Zeros [rad or m] below which springs, cables over two joints and tilts of the base looked like one, on five of
# 310 logs: 0.07 to 0.16.
_SIZABLE = {"revolute": 0.2, "prismatic": 0.08}


@dataclass(frozen=True)
class Guess:
    """One way in which a log may be wrong.

    Attributes:
        check: Name of the check it belongs to.
        what: The guess in words.
        mixture: Row j says which logged torques are joint j's, (n, n); None: as logged.
        motion: The motion it would be; None: as logged.
        joints: Joints it changes.
        nearby: Of a scale, the same guess with so many times its factor; None for what is no number.
        likely: Whether the motion itself says so, before any torque is asked.
        sizable: Of a zero, whether it is larger than those that springs, cables and tilts look like.
        arm: The robot it would be a log of; None: the one declared.
        of_robot: Whether nothing is wrong with the log, but with the robot it is declared of.
        remedy: What to do.
        told_only: Whether the log is fitted as it is.
    """

    check: str
    what: str
    joints: tuple[int, ...]
    mixture: np.ndarray | None = None
    motion: Callable[[Samples], Samples] | None = None
    nearby: Callable[[float], "Guess"] | None = None
    likely: bool = False
    sizable: bool = False
    arm: Robot | None = None
    of_robot: bool = False
    remedy: str = "Mend these columns of the log"
    told_only: bool = False

    @property
    def changes(self) -> int:
        """How many things would be wrong: that with fewer is likelier."""
        return 1 if self.arm is not None else len(self.joints)

    def moved(self, samples: Samples) -> Samples:
        """The log as it would be with the guess's motion."""
        return samples if self.motion is None else self.motion(samples)


def torque_guesses(robot: Robot) -> Iterator[Guess]:
    """Torques of the wrong sign, or in another order than the joints."""
    n = robot.num_joints
    if n <= _ALL_SIGNS:
        patterns = [p for p in product((1.0, -1.0), repeat=n) if min(p) < 0]
    else:
        one_each = np.where(np.eye(n) > 0, -1.0, 1.0)
        patterns = [tuple(map(float, row)) for row in (*one_each, -np.ones(n))]
    for pattern in patterns:
        wrong = tuple(int(j) for j in np.flatnonzero(np.asarray(pattern) < 0))
        text = f"the torque of {_named(robot, wrong)} has the wrong sign"
        yield Guess("torque_sign", text, wrong, np.diag(pattern))
    for order in _orders(n):
        yield _exchanged(robot, order)


def likely_order_guess(robot: Robot, order: tuple[int, ...]) -> Guess | None:
    """The torques in the order that each joint's own columns explain best; None if it is that of the joints."""
    return None if order == tuple(range(robot.num_joints)) else _exchanged(robot, order)


def _exchanged(robot: Robot, order: tuple[int, ...]) -> Guess:
    moved = tuple(j for j, k in enumerate(order) if j != k)
    text = f"the torques of {_named(robot, moved)} are exchanged"
    return Guess("swapped_channels", text, moved, np.eye(len(order))[list(order)])


def position_sign_guesses(robot: Robot) -> Iterator[Guess]:
    """The position of one joint with the wrong sign."""
    n = robot.num_joints
    for j in range(n):
        factor = np.where(np.arange(n) == j, -1.0, 1.0)
        text = f"the position of {robot.joints[j]} has the wrong sign"
        yield Guess("position_sign", text, (j,), motion=_scaled(factor))


def exchanged_positions(robot: Robot) -> Iterator[Guess]:
    """The positions of two joints exchanged."""
    n = robot.num_joints
    for j, k in combinations(range(n), 2):
        order = list(range(n))
        order[j], order[k] = k, j
        text = f"the positions of {_named(robot, (j, k))} are exchanged"
        yield Guess("swapped_channels", text, (j, k), motion=_ordered(order))


def degree_guesses(robot: Robot, far: np.ndarray) -> Iterator[Guess]:
    """Positions in degrees: of all turning joints, of those that turn too ``far``, (n,) of bool, or of all.

    A logger that converts its whole table multiplies the travel of slides as well.
    """
    turning = np.array([kind == "revolute" for kind in robot.kinds])
    sets = tuple(turning), tuple(turning & far), tuple(turning | turning.any())
    for chosen in dict.fromkeys(sets):
        joints = tuple(int(j) for j in np.flatnonzero(chosen))
        if joints:
            text = f"the positions of {_named(robot, joints)} are in degrees"
            factor = np.where(np.array(chosen), _DEGREE, 1.0)
            likely = bool(far[list(joints)].all())
            yield Guess("encoder_scale", text, joints, motion=_scaled(factor), likely=likely)


def torque_scale_guesses(robot: Robot) -> Iterator[Guess]:
    """A torque of one joint that is a multiple of what is logged.

    Couplings tell it: what one link asks of two joints, by its weight or its inertia, has to be of the same
    size on both. A joint that nothing couples to the others, such as the last one about an axis through its
    center of mass, or a single slide, may have any scale.
    """
    for j in range(robot.num_joints):
        for factor in _TORQUE_FACTORS:
            yield _torque_scale(robot, j, factor)


def motion_scale_guesses(robot: Robot) -> Iterator[Guess]:
    """Positions of one joint, or time, that are a multiple of what is logged.

    The same first moments make weights, which no clock changes, and inertial torques, which go with time
    squared; without gravity, or on a single joint, time may have any scale. A position scales its joint's
    turn in every other joint's torque; that of a slide without weight, or of a last joint about the axis
    of a body that is round, changes nothing that can be seen.
    """
    for factor in _MOTION_FACTORS:
        yield _time_scale(robot, factor)
        for j in range(robot.num_joints):
            yield _encoder_scale(robot, j, factor)


def zero_guess(robot: Robot, joint: int, zero: float) -> Guess:
    """A position [rad or m] that reads too large by a constant.

    Gravity and the couplings of links tell it; the zero of a first joint about a vertical axis, or of a last
    one about the axis of a round body, changes nothing that can be seen.
    """
    unit = "rad" if robot.kinds[joint] == "revolute" else "m"
    text = (
        f"the position of {robot.joints[joint]} reads {abs(zero):.2f} {unit} too "
        f"{'large' if zero > 0 else 'small'}, or a link before it is turned by that"
    )
    remedy = "Take it off the positions, or fit the offset of that encoder"
    sizable = abs(zero) > _SIZABLE[robot.kinds[joint]]
    moved = _moved(joint, -zero)
    return Guess(
        ENCODER_ZERO, text, (joint,), motion=moved, sizable=sizable, remedy=remedy, told_only=True
    )


def _torque_scale(robot: Robot, joint: int, factor: float) -> Guess:
    text = f"the torque of {robot.joints[joint]} is {_times(factor)} what is logged"
    mixture = np.diag(np.where(np.arange(robot.num_joints) == joint, factor, 1.0))
    return Guess(
        "torque_scale", text, (joint,), mixture,
        nearby=lambda times: _torque_scale(robot, joint, factor * times),
    )  # fmt: skip


def _encoder_scale(robot: Robot, joint: int, factor: float) -> Guess:
    text = f"the position of {robot.joints[joint]} is {_times(factor)} what is logged"
    one = np.where(np.arange(robot.num_joints) == joint, factor, 1.0)
    return Guess(
        "encoder_scale", text, (joint,), motion=_scaled(one),
        nearby=lambda times: _encoder_scale(robot, joint, factor * times),
    )  # fmt: skip


def _time_scale(robot: Robot, factor: float) -> Guess:
    text = f"time is {_times(1.0 / factor)} as long as logged, or the robot has other lengths or gravity"
    return Guess(
        "time_scale", text, tuple(range(robot.num_joints)), motion=_slower(factor),
        nearby=lambda times: _time_scale(robot, factor * times),
    )  # fmt: skip


def _times(factor: float) -> str:
    if factor in (0.5, 2.0):
        return "half" if factor == 0.5 else "twice"
    return f"{factor:g} times"


def _orders(n: int) -> Iterator[tuple[int, ...]]:
    """Orders of n channels other than their own: all of a few, exchanges of two of many."""
    same = tuple(range(n))
    if n <= _ALL_ORDERS:
        yield from (order for order in permutations(same) if order != same)
        return
    for j, k in combinations(same, 2):
        order = list(same)
        order[j], order[k] = k, j
        yield tuple(order)


def _scaled(factor: np.ndarray) -> Callable[[Samples], Samples]:
    def changed(s: Samples) -> Samples:
        return replace(s, q=factor * s.q, dq=factor * s.dq, ddq=factor * s.ddq)

    return changed


def _slower(factor: float) -> Callable[[Samples], Samples]:
    def changed(s: Samples) -> Samples:
        return replace(s, dq=factor * s.dq, ddq=factor**2 * s.ddq)

    return changed


def _moved(joint: int, by: float) -> Callable[[Samples], Samples]:
    def changed(s: Samples) -> Samples:
        return replace(s, q=s.q + by * (np.arange(s.q.shape[1]) == joint))

    return changed


def _ordered(order: list[int]) -> Callable[[Samples], Samples]:
    def changed(s: Samples) -> Samples:
        return replace(s, q=s.q[:, order], dq=s.dq[:, order], ddq=s.ddq[:, order])

    return changed


def _named(robot: Robot, joints: tuple[int, ...]) -> str:
    names = [robot.joints[j] for j in joints]
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
