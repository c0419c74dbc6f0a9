"""Columns of joints in another order than the robot's: positions and torques alike, or positions alone."""

from collections.abc import Callable, Iterator
from functools import partial
from itertools import combinations

import numpy as np

from jaxswarm.identify.checks.guess import Guess, named
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.samples import Samples
from jaxswarm.identify.checks.sound import Tried
from jaxswarm.robot.model import Robot

# What one more exchange has to gain, as a sum of logarithms. On 96 right logs no exchange of two joints gained
# more than 0.02, and from the last joint to the first cost 0.07 and more.
_WORTH = 0.2


def exchanged_positions(robot: Robot) -> Iterator[Guess]:
    """The positions of two joints exchanged."""
    for j, k in combinations(range(robot.num_joints), 2):
        order = _exchanged(np.arange(robot.num_joints), j, k)
        text = f"the positions of {named(robot, (j, k))} are exchanged"
        yield Guess(
            "swapped_channels", text, (j, k), motion=partial(Samples.reordered, positions=order)
        )


def column_order_guesses(
    robot: Robot, rough: Rough, logged: Tried
) -> Iterator[tuple[Guess, Tried]]:
    """The order of all columns that leaves least, if one leaves clearly less than the robot's own.

    A table without names may go from the last joint to the first, or be sorted by names. From its own order
    and from these, two joints after two others are exchanged as long as that gains: seven have 5040 orders.

    Args:
        robot: Kinematics.
        rough: Model of the log as it is.
        logged: What that leaves.
    """
    own = np.arange(robot.num_joints)

    def left(order: np.ndarray) -> Tried:
        return Rough(robot, rough.samples.reordered(order, order)).as_logged()[0]

    usual = [(left(o), o) for o in (own[::-1], np.argsort(np.argsort(np.array(robot.joints))))]
    starts = [(logged, own), *(one for one in usual if one[0].power < logged.power - _WORTH)]
    found = [_descended(left, *one) for one in starts]
    least, best = min(found, key=lambda one: one[0].power)
    if not np.array_equal(best, own):
        yield _guess(robot, best), least


def _descended(
    left: Callable[[np.ndarray], Tried], least: Tried, order: np.ndarray
) -> tuple[Tried, np.ndarray]:
    """The order to which exchanges of two lead as long as each gains, with what it leaves."""
    pairs = list(combinations(range(len(order)), 2))
    while pairs:
        tried = [(left(o), o) for o in (_exchanged(order, j, k) for j, k in pairs)]
        low, best = min(tried, key=lambda one: one[0].power)
        if low.power > least.power - _WORTH:
            break
        least, order = low, best
    return least, order


def _exchanged(order: np.ndarray, j: int, k: int) -> np.ndarray:
    other = order.copy()
    other[[j, k]] = order[[k, j]]
    return other


def _guess(robot: Robot, order: np.ndarray) -> Guess:
    moved = tuple(int(j) for j in np.flatnonzero(order != np.arange(len(order))))
    are = "from the last joint to the first"
    if not np.array_equal(order, np.arange(len(order))[::-1]):
        names = (robot.joints[int(j)] for j in np.argsort(order))
        are = f"in another order, they are those of {', '.join(names)}"
    return Guess(
        "swapped_channels",
        f"positions and torques are {are}",
        moved,
        motion=lambda samples: samples.reordered(order, order),
        remedy="Name the columns by their joints, or put them in the robot's order",
    )
