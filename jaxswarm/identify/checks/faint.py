"""A wrong scale, zero or sign that shows faintly in a rough model, asked of a fine one.

What a rough model leaves is mostly its own: it has one width of the smooth sign, and its columns are not
low-passed as the torque is. A fine one leaves of a clean log what the sensors make, so that a guess that is
right gains ten times as much, and one that is wrong gains nothing. What a model lacks may be made up for by any
scale; a reading that was taken once for twice is right at twice and at no other number.
"""

from collections.abc import Iterator

import numpy as np

from jaxswarm.identify.checks.guess import Guess, Scale, Zero
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.rough_fit import STRICTEST
from jaxswarm.identify.checks.sound import NONE, Tried, is_sound
from jaxswarm.robot.model import Robot

# Gain in a rough model, as a sum of logarithms, below which nothing shows.
_WORTH = 0.05
# Gain in a fine model from which on a scale is believed, and the same times the strictness of few rows. Of 310
# logs, clean ones, ones that lack a law and measured ones, twice and half the scale of every joint and of time
# gained 0.15 at most, but for a ripple (a torque 0.34), torques at their limit (an encoder 0.34) and few rows:
# time 0.5 where a stretch was left out, a torque 0.7 with two rows a parameter, whose strictness is 4. Of wrong
# scales that show in a rough model 95 % gain 0.7 and more, and 1.3 of few rows.
_FAINT, _FAINT_OF_FEW = 0.5, 0.3
# Zeros that are sizable gain less without being right; for them no log is refused.
_FAINT_ZERO, _FAINT_ZERO_OF_FEW = 0.35, 0.18
# Part of what a scale gains in a rough model that it gains in a fine one, too. Of 226 positions made twice or
# half on practice logs and worlds, that a rough model told, the least is 1.0; a play of a heavy slide on moves
# from point to point looked like half its position by 1.24 in a rough one and by less than 0.05 in a fine one.
_CONFIRMED = 0.5
# The scales beside it, as a ratio, and how near to it, as a logarithm, the least has to be.
_BESIDE, _NEAR = 1.3, 0.2
# Scales of a torque that a gain of its drive can be (``drive_gain``), which is a law to be found.
_GAINS = 0.5, 2.0


def clear_gain(robot: Robot, fine: Rough, guess: Guess) -> float:
    """By how much less a scale or a zero leaves of a fine model; zero where that does not bear it out.

    Args:
        robot: Kinematics.
        fine: Model of the log as it is.
        guess: A scale or a zero.
    """
    zero = isinstance(guess, Zero)
    logged, sigma = fine.as_logged()
    found = _tried(robot, fine, sigma, guess)
    least, of_few = (_FAINT_ZERO, _FAINT_ZERO_OF_FEW) if zero else (_FAINT, _FAINT_OF_FEW)
    gain = logged.power - found.power
    if gain < max(least, of_few * fine.strictness) or not is_sound(guess, found):
        return 0.0
    if isinstance(guess, Scale) and not _is_exact(robot, fine, sigma, guess, found.power):
        return 0.0
    return gain


def is_denied(robot: Robot, fine: Rough, guess: Guess, gain: float) -> bool:
    """Whether a scale that gains so much in a rough model gains far less in a fine one that has the rows.

    A rough model's columns are not low-passed, so that a motion with sharp ends bends them.
    """
    if not isinstance(guess, Scale) or fine.strictness >= STRICTEST:
        return False
    logged, sigma = fine.as_logged()
    return logged.power - _tried(robot, fine, sigma, guess).power < _CONFIRMED * gain


def brakes(fine: Rough, guess: Guess) -> bool:
    """Whether friction brakes every joint of a guess as logged, by a fine model that has the rows.

    A drive that jitters above the band bends the dry friction of a rough model, whose columns are not
    low-passed: on two right logs of slow motion it drove a joint by 0.8 of its torque, and braked it by 0.25
    and 0.5 in a fine model, which left a third and less of what the rough one did.
    """
    if fine.strictness >= STRICTEST:
        return False
    return bool(fine.as_logged()[0].braking[list(guess.joints)].min() > NONE)


def is_a_gain(robot: Robot, fine: Rough, guess: Guess) -> bool:
    """Whether a scale of a torque beside it, that the gain of a drive can have, leaves far less than it.

    A gain of 0.7 was refused as a torque of twice what is logged, where 1.4 times leaves a tenth of that.
    """
    if guess.check != "torque_scale" or fine.strictness >= STRICTEST:
        return False
    _, sigma = fine.as_logged()
    clearly = max(_FAINT, _FAINT_OF_FEW * fine.strictness)
    most = _tried(robot, fine, sigma, guess).power - clearly
    return any(_tried(robot, fine, sigma, one).power < most for one in _gains_beside(guess))


def _gains_beside(guess: Guess) -> Iterator[Guess]:
    """The scales beside a torque's that the gain of its drive can be."""
    if not isinstance(guess, Scale) or guess.mixture is None:
        return
    for times in (1.0 / _BESIDE, _BESIDE):
        if _GAINS[0] < guess.factor * times < _GAINS[1]:
            yield guess.nearby(times)


def is_worth(guess: Guess, gain: float) -> bool:
    """Whether a fine model may be asked about a guess that gains so much in a rough one."""
    return gain > _WORTH and (
        isinstance(guess, Scale) or (isinstance(guess, Zero) and guess.sizable)
    )


def _is_exact(robot: Robot, fine: Rough, sigma: np.ndarray, guess: Scale, here: float) -> bool:
    """Whether what is left has its least at this scale, as far as those beside it tell."""
    low, high = (
        _tried(robot, fine, sigma, guess.nearby(times)).power for times in (1.0 / _BESIDE, _BESIDE)
    )
    bend = low - 2.0 * here + high
    return bool(bend > 0.0 and abs(0.5 * np.log(_BESIDE) * (low - high)) < _NEAR * bend)


def _tried(robot: Robot, fine: Rough, sigma: np.ndarray, guess: Guess) -> Tried:
    if guess.mixture is not None:
        return fine.fit([guess.mixture], sigma)[0]
    return Rough(robot, guess.moved(fine.samples)).as_logged()[0]
