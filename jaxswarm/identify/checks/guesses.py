"""What a log might be instead: other signs, scales or clocks, torques exchanged; each as a changed log."""

from collections.abc import Iterator
from functools import partial
from itertools import combinations, permutations, product

import numpy as np

from jaxswarm.identify.checks.guess import Guess, Scale, Zero, named, times
from jaxswarm.identify.checks.samples import Samples
from jaxswarm.robot.model import Robot

# Joints up to which every order of the torques and every pattern of signs is tried.
_ALL_ORDERS, _ALL_SIGNS = 4, 8
# Wrong scales: of a reading that is taken once for twice.
_MOTION_FACTORS = (0.5, 2.0)
ENCODER_ZERO = "encoder_zero"
# Zeros [rad or m] below which springs, cables over two joints and tilts of the base looked like one, on five of
# 310 logs: 0.07 to 0.16.
_SIZABLE = {"revolute": 0.2, "prismatic": 0.08}


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
        text = f"the torque of {named(robot, wrong)} has the wrong sign"
        yield Guess("torque_sign", text, wrong, np.diag(pattern))
    for order in _orders(n):
        yield _exchanged(robot, order)


def likely_order_guess(robot: Robot, order: tuple[int, ...]) -> Guess | None:
    """The torques in the order that each joint's own columns explain best; None if it is that of the joints."""
    return None if order == tuple(range(robot.num_joints)) else _exchanged(robot, order)


def _exchanged(robot: Robot, order: tuple[int, ...]) -> Guess:
    moved = tuple(j for j, k in enumerate(order) if j != k)
    text = f"the torques of {named(robot, moved)} are exchanged"
    return Guess("swapped_channels", text, moved, np.eye(len(order))[list(order)])


def position_sign_guesses(robot: Robot) -> Iterator[Guess]:
    """The position of one joint with the wrong sign."""
    n = robot.num_joints
    for j in range(n):
        factor = np.where(np.arange(n) == j, -1.0, 1.0)
        text = f"the position of {robot.joints[j]} has the wrong sign"
        yield Guess("position_sign", text, (j,), motion=partial(Samples.placed, scale=factor))


def motion_scale_guesses(robot: Robot) -> Iterator[Scale]:
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


def zero_guess(robot: Robot, joint: int, zero: float) -> Zero:
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
    shift = -zero * (np.arange(robot.num_joints) == joint)
    moved = partial(Samples.placed, zero=shift)
    return Zero(
        ENCODER_ZERO, text, (joint,), motion=moved, remedy=remedy, told_only=True, sizable=sizable
    )


def _encoder_scale(robot: Robot, joint: int, factor: float) -> Scale:
    text = f"the position of {robot.joints[joint]} is {times(factor)} what is logged"
    one = np.where(np.arange(robot.num_joints) == joint, factor, 1.0)
    return Scale(
        "encoder_scale", text, (joint,), motion=partial(Samples.placed, scale=one),
        factor=factor, nearby=lambda more: _encoder_scale(robot, joint, factor * more),
    )  # fmt: skip


def _time_scale(robot: Robot, factor: float) -> Scale:
    text = f"time is {times(1.0 / factor)} as long as logged, or the robot has other lengths or gravity"
    return Scale(
        "time_scale", text, tuple(range(robot.num_joints)), motion=partial(Samples.faster, factor=factor),
        factor=factor, nearby=lambda more: _time_scale(robot, factor * more),
    )  # fmt: skip


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
