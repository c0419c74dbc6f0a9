"""A torque that measures nothing but its noise: no motion explains it, and the other joints contradict it."""

import numpy as np

from jaxswarm.identify.checks.relation import NO_RELATION
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.sound import UNRELATED
from jaxswarm.logs.finding import Finding
from jaxswarm.robot.model import Robot

# A joint is contradicted where the others, fitted without it, lower the sum of the logarithms of what is left
# of them by this much, times the log's strictness: on 24 logs that are clean or lack a law no joint did by more
# than 0.6, and none had more than 0.4 of its torque left; of 120 others none is complained of. Noise in place
# of a torque that holds links gains 0.8 to 20; a last joint that weighs little contradicts nobody.
_CONTRADICTED = 0.8
# Share of its torque that a joint's own columns alone leave at least of noise: 0.78 to 1.01 on all joints of
# ten arms, of clean torques 0.42 at most, of a law that nobody knows on a light last joint 0.55.
_ALONE = 0.7
# Share left from which on nothing of a torque follows the motion, to be told where nobody contradicts it.
_NOTHING = 0.95
# Rounds of weights after which all that is said here was measured.
_BEFORE = 3
# A standard deviation so many times the largest is that of a joint that does not count.
_OUT = 1e9


def dead_torque(robot: Robot, rough: Rough) -> Finding | None:
    """The joint whose torque no motion explains; refused where it spoils the fit of the others.

    A channel that is not connected shows a little noise, which a fit weighted by what it leaves takes for the
    best sensor of all: every joint is then fitted to nothing.

    Args:
        robot: For the names.
        rough: Model of the log as it is.
    """
    # Weights that have settled leave out what is noise, and it contradicts nobody.
    logged, sigma = rough.settled(np.eye(len(rough.spread)), _BEFORE)
    if len(sigma) == 1:
        return None
    silent = [j for j in np.flatnonzero(logged.left >= UNRELATED) if rough.alone(int(j)) > _ALONE]
    if not silent:
        return None
    without = {int(j): _without(rough, int(j), sigma) for j in silent}
    gains = {
        j: float(np.log(np.delete(logged.left, j) / left).sum()) for j, left in without.items()
    }
    worst = max(gains, key=gains.__getitem__)
    if gains[worst] > _CONTRADICTED * rough.strictness:
        name, others = robot.joints[worst], np.delete(logged.left, worst)
        what = (
            f"the torque of {name} has nothing to do with the motion: with it rigid body and friction leave "
            f"{_percent(others)} of the other torques, without it {_percent(without[worst])}"
        )
        remedy = f"Log it again, or hold what nobody moves still: --lock {name}"
        return Finding(NO_RELATION, what, remedy)
    alone = [robot.joints[j] for j in silent if logged.left[j] >= _NOTHING]
    if not alone:
        return None
    what = f"nothing of the torque of {' and '.join(alone)} follows the motion: it is noise, or another joint's"
    return Finding(
        NO_RELATION, what, "Check its sensor and the order of the columns", refused=False
    )


def _without(rough: Rough, joint: int, sigma: np.ndarray) -> np.ndarray:
    """What is left of the other torques where one joint does not count, (n - 1,)."""
    same = np.eye(len(sigma))
    for _ in range(2):  # the second time with the weights of what is left
        sigma = sigma.copy()
        sigma[joint] = _OUT * rough.spread.max()
        found = rough.fit([same], sigma)[0]
        sigma = np.maximum(found.left * rough.spread, 1e-9)
    return np.delete(np.maximum(found.left, 1e-9), joint)


def _percent(left: np.ndarray) -> str:
    return f"{100 * float(np.exp(np.log(np.minimum(left, 1.0)).mean())):.2g} %"
