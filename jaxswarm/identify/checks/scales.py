"""A wrong scale that gains little, but is exactly the scale at which least is left.

What a model lacks may be made up for by any scale; a reading that was taken once for twice is right at twice
and at no other number.
"""

import numpy as np

from jaxswarm.identify.checks.guesses import Guess
from jaxswarm.identify.checks.rough import Rough, Tried
from jaxswarm.robot.model import Robot

# Gain, as a sum of logarithms, from which on a scale is looked at closely: of twice and half the scale of every
# joint of 120 logs, clean ones, ones that lack a law and measured ones, none gains more than 0.11 of a torque,
# 0.15 of an encoder and 0.06 of time where the log is sure: it has the rows for its parameters, and all joints
# are explained but for this share. Time gained 0.25 on one of which a third was left out.
_FAINT = {"torque_scale": 0.18, "time_scale": 0.28, "encoder_scale": 0.25}
_WELL = 0.15
# Others have gained 0.37 times their strictness (few rows, a right torque) and 0.3 (an encoder, torques at
# their limit): there a scale has to gain more, and its least to lie nearer.
_FAINT_UNSURE = {"torque_scale": 0.4, "time_scale": 0.28, "encoder_scale": 0.4}
# The scales beside it, as a ratio, and how near to it, as a logarithm, the least has to be: right ones that
# gain little lie within 0.2 of it, but for joints of which a law is missing.
_BESIDE, _NEAR, _NEAR_UNSURE = 1.3, 0.2, 0.12


def is_exact(robot: Robot, rough: Rough, sigma: np.ndarray, guess: Guess, gain: float) -> bool:
    """Whether what is left has its least at this scale, as far as those beside it tell.

    Args:
        robot: Kinematics.
        rough: Model of the log as it is.
        sigma: Its weights, (n,).
        guess: A scale; false of anything else.
        gain: By how much less it leaves than the log as it is, as a sum of logarithms.
    """
    if guess.nearby is None:
        return False
    if gain < _FAINT[guess.check] * rough.strictness:
        return False
    sure = rough.strictness == 1.0 and rough.as_logged()[0].left.max() < _WELL
    if not sure and gain < _FAINT_UNSURE[guess.check] * rough.strictness:
        return False
    low, here, high = (
        _tried(robot, rough, sigma, guess.nearby(times)).power
        for times in (1.0 / _BESIDE, 1.0, _BESIDE)
    )
    bend = low - 2.0 * here + high
    return bool(
        bend > 0.0
        and abs(0.5 * np.log(_BESIDE) * (low - high)) < (_NEAR if sure else _NEAR_UNSURE) * bend
    )


def _tried(robot: Robot, rough: Rough, sigma: np.ndarray, guess: Guess) -> Tried:
    if guess.mixture is not None:
        return rough.fit([guess.mixture], sigma)[0]
    return Rough(robot, guess.moved(rough.samples)).as_logged()[0]
