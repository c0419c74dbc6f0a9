"""A base that is mounted otherwise than declared: on a wall, under a ceiling, or on its edge.

First moments of links make weights and couplings of inertia alike, so that a log tells the direction of its
own gravity. On 84 of 85 logs, clean ones and ones that lack a law, no other side of the base up left less than
the one declared. Of 193 that were declared on a wrong side 177 are told, with the right one; of the others most
are level arms and slow motion, of which gravity turned upside down asks the same.
"""

from collections.abc import Iterator
from itertools import product

import jax.numpy as jnp
import numpy as np

from jaxswarm.identify.checks.guess import OtherRobot
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.sound import Tried
from jaxswarm.robot.logged import rigid_columns
from jaxswarm.robot.model import Robot

MOUNTING = "mounting"
# What the best side has to gain, as a sum of logarithms, before directions between sides are tried.
_WORTH = 0.2
# Cosine of the angle from the best side to those that are tried beside it: its edges and corners.
_BESIDE = 0.5
# Part of what its joints gain that others may lose by the right direction. Of 26 logs declared on a wrong side
# one joint lost a twentieth, the others nothing; where friction was missing on the joint of an upright axis, a
# base on its edge gained as much as two other joints lost.
_LOST = 0.1
# Part of the largest weight on a turning joint below which it carries none.
_NO_WEIGHT = 1e-6


def mounting_guesses(
    robot: Robot, rough: Rough, logged: Tried
) -> Iterator[tuple[OtherRobot, Tried]]:
    """The direction of gravity that leaves least, if one leaves clearly less than the one declared.

    Args:
        robot: Kinematics, with the gravity declared.
        rough: Model of the log as it is.
        logged: What that leaves.
    """
    declared = np.asarray(robot.gravity, float)
    size = float(np.linalg.norm(declared))
    if size == 0.0:
        return

    def left(direction: np.ndarray) -> Tried:
        return Rough(_along(robot, size * direction), rough.samples).as_logged()[0]

    every = [np.array(d) / np.linalg.norm(d) for d in product((-1.0, 0.0, 1.0), repeat=3) if any(d)]
    sides = [d for d in every if np.count_nonzero(d) == 1 and d @ declared < (1 - 1e-9) * size]
    tried = [(left(d), d) for d in sides]
    low, best = min(tried, key=lambda one: one[0].power)
    if low.power > logged.power - _WORTH:
        return
    beside = [d for d in every if np.count_nonzero(d) > 1 and d @ best > _BESIDE]
    tried = [(low, best), *((left(d), d) for d in beside)]
    found, direction = min(tried, key=lambda one: one[0].power)
    change = found.logarithms - logged.logarithms
    if np.maximum(change, 0.0).sum() > -_LOST * np.minimum(change, 0.0).sum():
        return
    yield _guess(robot, rough, size * direction), found


def _guess(robot: Robot, rough: Rough, gravity: np.ndarray) -> OtherRobot:
    numbers = ",".join(f"{x:.3g}" for x in gravity + 0.0)
    text = (
        f"the base is mounted otherwise than declared, free fall is along ({numbers}) m/s^2 of it"
    )
    return OtherRobot(
        MOUNTING,
        text,
        tuple(range(robot.num_joints)),
        arm=_along(robot, gravity),
        remedy=f"Pass --gravity {numbers}, or turn the base in the robot's file",
        told_only=not _carries_weight(robot, rough.samples.q),
    )


def _along(robot: Robot, gravity: np.ndarray) -> Robot:
    return robot.replace(gravity=jnp.asarray(gravity))


def _carries_weight(robot: Robot, q: np.ndarray) -> bool:
    """Whether gravity as declared turns any joint.

    Where it turns none, a law of the positions may do to the joints what gravity along another side would: a
    pull on the forearm of a level arm took five sixths off what is left. No log is refused for that.
    """
    turning = np.array([kind == "revolute" for kind in robot.kinds])
    weight = rigid_columns(robot, q, 0.0 * q, 0.0 * q)[:, turning]
    scale = float(np.linalg.norm(robot.gravity)) * max(float(np.abs(q).max()), 1.0)
    return bool(weight.size and np.abs(weight).max() > _NO_WEIGHT * scale)
