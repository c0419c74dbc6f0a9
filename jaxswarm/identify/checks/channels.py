"""Signs, order and unit of channels, by what the robot's geometry and its friction say.

Friction brakes. A torque or a position of the wrong sign makes it drive the arm, and where joints are coupled
it also leaves more of the torque; an exchange of two channels leaves far more. A guess is believed where it
leaves much less than the log as it is, or as little with friction that brakes where it drove.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from jaxswarm.identify.checks.every_guess import every_guess
from jaxswarm.identify.checks.faint import brakes, clear_gain, is_a_gain, is_denied, is_worth
from jaxswarm.identify.checks.guess import Guess, OtherRobot, Zero
from jaxswarm.identify.checks.guesses import ENCODER_ZERO
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.samples import Samples
from jaxswarm.identify.checks.sound import NONE, UNLESS, UNRELATED, Tried, is_sound, may_be
from jaxswarm.logs.finding import Finding
from jaxswarm.robot.model import Robot

# A guess is believed that lowers the sum over the joints of the logarithm of what is left by this much,
# half on one joint. On 110 clean logs of 26 arms no guess with braking friction lowered it at all, while
# wrong ones lower it by 2 and more, of noisy slow logs by 0.9.
_MUCH = 0.7
# A sign is no number that could bend into what is missing: where friction brakes in what it leaves, no
# pattern of signs of 140 logs, clean ones, ones that lack a law and measured ones, lowered it by more than
# 0.05 times the log's strictness, while a last joint of light friction may gain no more than 0.4.
_SIGN = 0.3
# The right sign leaves no more of its own joint: a torque by the sum of two positions, which acted on both,
# gained 1.1 in all by a wrong one, of whose joint 0.97 was left instead of 0.73.
_OWN_SIGN = 0.1
# Or leaves as much, to this difference, where friction drove with this share of the torque: on clean logs it is
# 0.04 at most, on joints without friction. It is at least this part of what is left there: of a last joint
# whose load was put down in mid-log 45 % of the torque was left, and friction drove it with 12 %.
_SAME, _DRIVES, _OF_LEFT = 0.3, 0.08, 1 / 3
_SIGNS = {"torque_sign", "position_sign"}
# Where friction drove nothing, the right sign leaves no more than this part of what is left as logged, or the
# log goes on: one that lacked a load as heavy as its last link left 48 % of the torque, with a wrong sign 43 %.
_LEAVES_MUCH = 0.8
# Scales are believed where they lower that sum by less: nothing but the scale changes, so that on 305 logs that
# are clean or lack a law no torque's scale lowers it by more than 0.3 and time's by 0.35. A last joint's
# position may bend into what is missing by 0.5. Twice the scale costs 0.4 to 10 where it can be seen. No zero
# lowers it by a tenth there; one that is 0.3 off does by 0.8 and more where it shows.
_SCALES = {"torque_scale": 0.55, "time_scale": 0.45, "encoder_scale": 0.8, ENCODER_ZERO: 0.4}
# A torque's scale is a valley: any other scale of it costs this part of that more. Where a joint disagrees with
# the others for another reason, all scales that take its word from it help alike.
_VALLEY = 0.5
# Travel [rad or m] below which a position is one number but for the rounding of its smoothing.
STANDS = 1e-9
# Rows per parameter that a fit has to have before it tells anything.
_ROWS_PER_PARAMETER = 3.0


def enough(robot: Robot, samples: Samples, rows_each: float = _ROWS_PER_PARAMETER) -> bool:
    """Whether a rough fit tells anything: enough rows, and all joints move."""
    rows = samples.q.size
    return bool(
        rows >= rows_each * 14 * robot.num_joints and (np.ptp(samples.q, axis=0) >= STANDS).all()
    )


def wrong_channels(
    robot: Robot, rough: Rough, fine: Callable[[], Rough], *, every_joint: bool = False
) -> Finding | None:
    """The likeliest guess about signs, order and unit of angles that is far better than the log as it is.

    Args:
        robot: Kinematics.
        rough: Model of the log as it is.
        fine: Makes a fine one, where a scale or a zero shows faintly.
        every_joint: Whether a guess has to explain the torque of every joint: where one contradicts the others,
            most guesses bend the others towards it.
    """
    logged, sigma = rough.as_logged()
    much = rough.strictness
    tried = every_guess(robot, rough, logged, sigma)
    tried = [(g, t) for g, t in tried if not _bends(g, t, tried)]
    if every_joint:
        tried = [(g, t) for g, t in tried if t.left.max() < UNRELATED]
    believed = [
        (g, t)
        for g, t in tried
        if is_sound(g, t) and _believed(g, t, logged, much) and _is_valley(g, t, tried, much)
    ]
    believed = [
        (g, t)
        for g, t in believed
        if not is_denied(robot, fine(), g, logged.power - t.power)
        and not (g.check in _SIGNS and brakes(fine(), g))
    ]
    faint = [one for one in tried if is_worth(one[0], logged.power - one[1].power)]
    gains = [clear_gain(robot, fine(), g) for g, _ in faint]
    # A fine model tells apart what a rough one leaves alike.
    believed += [
        one for one, gain in zip(faint, gains, strict=True) if gain > max(0.0, max(gains) - _SAME)
    ]
    if not believed:
        return None
    best = min(t.power for _, t in believed)
    if not all(g.told_only for g, _ in believed):
        # A log that is refused anyhow is told the likeliest cause, though much is left with that too.
        likelier: list[tuple[Guess, Tried]] = [
            (g, t)
            for g, t in tried
            if isinstance(g, OtherRobot) and t.power < best - _SAME and may_be(t)
        ]
        believed, best = believed + likelier, min([best, *(t.power for _, t in likelier)])
    alike = [(g, t) for g, t in believed if t.power < best + _SAME]
    guess, found = min(
        alike, key=lambda one: (one[0].changes, one[0].motion is not None, one[1].power)
    )
    if is_a_gain(robot, fine(), guess):
        return None  # a law to be found; what explains less of it is told neither
    return _told(robot, _with_rivals(robot, guess, [g for g, _ in alike]), found, logged)


def _with_rivals(robot: Robot, guess: Guess, alike: list[Guess]) -> Guess:
    """The guess, naming what explains the log as well."""
    mirrored = {g.check for g in alike if g.joints == guess.joints} >= _SIGNS
    if mirrored:  # as at a vertical base
        guess = replace(
            guess, what=guess.what.replace("the torque of", "the torque or the position of")
        )
    # A guess that both a rough and a fine model bear out is among them twice.
    rivals = dict.fromkeys(
        robot.joints[g.joints[0]]
        for g in alike
        if g.check == guess.check and len(g.joints) == 1 and g.joints != guess.joints
    )
    if rivals:  # as of parallel axes
        guess = replace(guess, what=f"{guess.what} (or that of {' or '.join(rivals)})")
    if not isinstance(guess, OtherRobot):
        return guess
    for other in (g for g in alike if isinstance(g, OtherRobot) and g.check != guess.check):
        # An arm under a ceiling, and one whose second joint is zero upside down.
        remedy = f"{guess.remedy}; or {other.remedy[0].lower()}{other.remedy[1:]}"
        guess = replace(guess, what=f"{guess.what}, or {other.what}", remedy=remedy)
    return guess


def _believed(guess: Guess, found: Tried, logged: Tried, much: float) -> bool:
    """Whether a guess leaves clearly less; scales have to, so many times (``much``) more."""
    joints = list(guess.joints)
    change = found.power - logged.power
    worse = (found.logarithms - logged.logarithms)[joints].sum()
    if guess.check in _SIGNS and worse > _OWN_SIGN:
        return False
    own = logged.braking[joints]
    clear = np.maximum(_DRIVES, _OF_LEFT * logged.left[joints]).mean()
    drove = bool(own.max() < 0.0 and own.mean() < -clear)
    needed = much * _SCALES[guess.check] if guess.check in _SCALES else _MUCH
    if guess.check in _SIGNS:
        needed = min(needed, much * _SIGN)
    needed = needed if guess.needed is None else guess.needed
    return change < -needed or (guess.check in _SIGNS and change < _SAME and drove)


def _is_valley(guess: Guess, found: Tried, tried: list[tuple[Guess, Tried]], much: float) -> bool:
    """Whether all other scales of the same torque are clearly worse; true of what is no such scale."""
    if guess.check != "torque_scale" or len(guess.joints) > 1:
        return True
    others = [
        t.power
        for g, t in tried
        if g is not guess and (g.check, g.joints) == (guess.check, guess.joints)
    ]
    return found.power < min(others) - _VALLEY * much * _SCALES[guess.check]


def _bends(guess: Guess, found: Tried, tried: list[tuple[Guess, Tried]]) -> bool:
    """Whether a position's scale bends into what is missing: a mere zero leaves less of its own joint.

    Of a position that is half what is logged nothing else does. A last joint that turned by a seventh of
    another one's angle besides was told so, with 6 % of its torque left, of which a zero left 5 %: the log was
    refused, and lacked a gear coupling.
    """
    if guess.check != "encoder_scale":
        return False
    own = list(guess.joints)
    return any(isinstance(g, Zero) and t.left[own].max() < found.left[own].max() for g, t in tried)


def _told(robot: Robot, guess: Guess, found: Tried, logged: Tried) -> Finding:
    drove = [robot.joints[j] for j in guess.joints if logged.braking[j] < -NONE]
    driven = f"friction would drive {', '.join(drove)}, and " if drove else ""
    what = (
        f"{guess.what}: as logged {driven}rigid body and friction leave {100 * logged.size:.2g} % of the "
        f"torque, without it {100 * found.size:.2g} %"
    )
    may_be_else = guess.check in _SIGNS and not drove and found.size > _LEAVES_MUCH * logged.size
    what += UNLESS if may_be_else else ""
    refused = not (guess.told_only or may_be_else)
    return Finding(guess.check, what, guess.remedy, refused=refused)
