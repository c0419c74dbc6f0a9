"""Joints whose encoder has another zero than the robot's file: searched for, because it may be any number."""

from collections.abc import Iterator

import scipy

from jaxswarm.identify.checks.guess import Zero
from jaxswarm.identify.checks.guesses import zero_guess
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.sound import Tried
from jaxswarm.robot.model import Robot

# Zeros [rad or m] that every joint is asked for, whatever the log; and how many times that is the farthest.
_PROBE, _FARTHEST = {"revolute": 0.12, "prismatic": 0.05}, 8.0
# Logarithm of what is left that such a probe has to gain before the zero is searched for: on 67 clean logs of
# 50 arms no probe of any size gained a tenth, while halfway to a zero that is 0.3 off it is 0.3 and more; where
# it gains less only a sizable zero is one.
_WORTH, _FAINTLY = 0.15, 0.05
# Width [rad or m] to which a zero is searched for, and models that one search may cost.
_WIDTH, _MOST = 0.01, 16


def zero_guesses(robot: Robot, rough: Rough, logged: Tried) -> Iterator[tuple[Zero, Tried]]:
    """For every joint the zero that leaves least, if one leaves clearly less than the log as it is.

    Args:
        robot: Kinematics.
        rough: Model of the log as it is.
        logged: What that leaves.
    """
    for joint, kind in enumerate(robot.kinds):
        known: dict[float, Tried] = {}

        def left(zero: float, joint: int = joint, known: dict[float, Tried] = known) -> float:
            guess = zero_guess(robot, joint, zero)
            known[zero] = Rough(robot, guess.moved(rough.samples)).as_logged()[0]
            return known[zero].power

        probe = _PROBE[kind]
        low, zero = min((left(side), side) for side in (-probe, probe))
        if low > logged.power - _FAINTLY:
            continue
        ends = sorted((0.0, _FARTHEST * zero))
        found = scipy.optimize.minimize_scalar(
            left, bounds=ends, method="bounded", options={"xatol": _WIDTH, "maxiter": _MOST}
        )
        best = float(found.x)
        guess = zero_guess(robot, joint, best)
        if guess.sizable or low < logged.power - _WORTH:
            yield guess, known[best]
