"""Whether an addition proves itself: it stands for no other law, and survives on motion it was not fitted to.

It has to lower the error of its joint there, and must not raise that of any joint: on other logs where there
are any, the worst one deciding, else on regions of states held out one after the other. Within one log it has
to lower the error of its joint where it is fitted as well, and must not raise it on any stretch of time that
the rest of the log predicts: on a measured log of five seconds that took back an encoder's zero 24 degrees off,
a cable and a saturation, each worth a fifth of its joint's squared error in alternating blocks.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.candidates.position_laws import hardly_repeats
from jaxswarm.diagnose.decision.own_variables import left_of_own
from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import (
    ABOVE_NOISE,
    GAIN,
    HARM,
    HARM_ON_THE_WAY,
    LOST,
    LOST_SHARE,
    NEAR,
    NEARLY_ALL,
    ONE_PLACE,
    OUTWEIGHED,
    SMALL_PART,
    TIMES_OWN,
    Rules,
)
from jaxswarm.diagnose.decision.unexplained import (
    Unexplained,
    find_unexplained,
    with_smooth_terms,
)
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.noise import noise_of
from jaxswarm.diagnose.folds.partial_out import CrossFit, cross_fit
from jaxswarm.diagnose.selection.elsewhere import errors_elsewhere, expected, log_residual, rms
from jaxswarm.diagnose.selection.step import Step
from jaxswarm.diagnose.selection.stretches import on_stretches
from jaxswarm.diagnose.selection.unconfirmed import unconfirmed
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.logs.motion import Motion

UNSHOWN = "cannot be shown: no part of the log predicts another, so record another motion"


def stands_in(chosen: Score, current: Estimate, crossfit: CrossFit, seed: int) -> bool:
    """Whether a law only stands in for one that no catalog holds.

    That is so if it explains a small part of what a smooth function of one or two variables explains nearly all
    of, both of what the noise leaves: of friction by another joint's speed, at twice the noise, a load friction
    took 0.32 and a function of both speeds 0.69, where nothing can take more than 0.75.
    """
    if chosen.share > SMALL_PART or chosen.candidate.term.joint is None:
        return False
    smooth = find_unexplained(current, crossfit, seed, [chosen.joint])
    if not smooth:
        return False
    told = smooth[0].share
    most = max(1.0 - over_noise(current)[chosen.joint] ** -2.0, told)
    small = chosen.share <= SMALL_PART * most
    return bool(small and told > max(NEARLY_ALL * most, TIMES_OWN * chosen.share))


def one_place(after: Estimate, added: Term, rules: Rules, seed: int) -> str | None:
    """Why an order of which few periods are seen is none: what it leaves still follows what it is about.

    A magnet of 0.15 rad on a cycle of 0.6 rad was told as a ripple of 1.5 periods, at 1.8 times the noise, and
    doubled the error of motion that went further; a drag between two angles as friction of 1.2 periods, at 1.6.
    """
    if not hardly_repeats(added, after.motions):
        return None
    share, p_value = left_of_own(after, cross_fit(after), added, seed)
    if share < ONE_PLACE or p_value > rules.significance:
        return None
    return "is seen through too few periods and leaves what follows its own variables: move the joint further"


def survives(
    before: Estimate,
    after: Estimate,
    joint: int,
    other: Sequence[Motion] = (),
    rules: Rules | None = None,
) -> str | None:
    """Why an addition does not survive; None if it does.

    The error of its own joint has to fall, and that of all joints, in units of their noise; on another log what
    fits are expected to leave there counts as noise (:func:`expected`). Where more is
    missing, one that is true may raise a joint's error until the rest is found; what does so in the end
    is taken back by :func:`harmful`.

    Args:
        before, after: The fits without and with it.
        joint: Where it acts, or shows most.
        other: Logs that are not fitted.
        rules: Thresholds.
    """
    why = unconfirmed(before, after, joint, rules or Rules())
    if why:
        return why
    noise = noise_of(before)
    names = before.model.robot.joints
    predicts, raises = (False, False) if other else on_stretches(before, after, joint)
    if raises:
        return f"raises the error of {names[joint]} on stretches that the rest of the log predicts"
    elsewhere = list(errors_elsewhere(before, after, other))
    if not predicts and not elsewhere:
        return UNSHOWN
    for number, (one, two, falls, rises, where) in enumerate(elsewhere):
        worse = rises & _grows(one, two, noise, HARM_ON_THE_WAY, other)
        floor = noise
        if other and (worse.any() or more_in_all(two, one, noise)):
            floor = expected(other[number], noise, before, after)
            worse &= two > ABOVE_NOISE * floor
        if worse.any():
            j = int(np.argmax(np.where(worse, two / np.maximum(one, 1e-300), 0.0)))
            return f"raises the error of {names[j]} {where} from {one[j]:.3g} to {two[j]:.3g}"
        if not falls[joint]:
            return f"does not lower the error of {names[joint]} {where}"
        if more_in_all(two, one, floor):
            return f"does not lower the error of all joints {where}"
    return None


def _grows(
    before: np.ndarray,
    error: np.ndarray,
    noise: np.ndarray,
    times: float,
    other: Sequence[Motion],
) -> np.ndarray:
    """Whether each joint's error (n,) is so many times what it was, above the noise, and weighs in one log."""
    more = (error > times * before) & (error > ABOVE_NOISE * noise)
    return more if other else more & ~outweighed(before, error, noise)


def outweighed(before: np.ndarray, error: np.ndarray, noise: np.ndarray) -> np.ndarray:
    """Whether a rise of each joint's squared error (n,) is a small part of the falls of all others.

    Regions of one log are predicted by what is left of it: where that tells little of a motion, a true law may
    raise a joint's error there, by what else is missing.
    """
    rise = np.square(error / noise) - np.square(before / noise)
    return rise < OUTWEIGHED * np.maximum(-rise, 0.0).sum()


def more_in_all(error: np.ndarray, before: np.ndarray, noise: np.ndarray) -> bool:
    """Whether the errors of all joints (n,) are more than before, in units of the noise and as shares alike.

    What is within the noise counts as it. In units of the noise a joint that lacks a law of its own decides: an
    offset that halved its joint's error was refused, since another joint's rose by a hundredth, from eleven
    times its noise. As shares a few that are near the noise outweigh one that is far from it.
    """
    over, former = (np.maximum(e / noise, ABOVE_NOISE) for e in (error, before))
    ratio = over / former
    return bool((over**2 - former**2).sum() > 0.0 and np.log(ratio).sum() > 0.0)


def harmful(
    declared: Estimate, steps: Sequence[Step], final: Estimate, other: Sequence[Motion] = ()
) -> tuple[Step, str] | None:
    """The addition that in the end raises a joint's error on other motion most, and where; None if none.

    One that is shown beyond doubt there may raise that of another joint as on the way: what both share, such as
    inertias and clocks, is known only as well as the log tells, and it is the better model for all that. A drag
    that took 99 % off 74 times the noise on another log was taken back, since the next joint's error rose from
    2.2 to 2.8 times its noise.

    Args:
        declared: The fit of the declared model.
        steps: What was added.
        final: The fit with all of it.
        other: Logs that are not fitted.
    """
    noise = noise_of(final)
    names = final.model.robot.joints
    for number, (one, two, _, rises, where) in enumerate(errors_elsewhere(declared, final, other)):
        worse = rises & _grows(one, two, noise, HARM, other)
        if other and worse.any():
            worse &= two > ABOVE_NOISE * expected(other[number], noise, declared, final)
        if not worse.any():
            continue
        j = int(np.argmax(np.where(worse, two / np.maximum(one, 1e-300), 0.0)))
        little = two[j] <= HARM_ON_THE_WAY * one[j]
        raised = []
        for step in steps:
            pairs = [(a, b) for a, b, *_ in errors_elsewhere(step.before, step.after, other)]
            shown = step.added.law.in_one_log or _beyond_doubt(step, pairs, noise)
            if little and step.added.joint != j and shown:
                continue
            raised.append((max((b[j] - a[j] for a, b in pairs), default=0.0), step))
        rise, worst = max(raised, key=lambda item: item[0], default=(0.0, None))
        if worst is not None and rise > 0.0:
            told = f"raises the error of {names[j]} {where} from {one[j]:.3g} to {two[j]:.3g}"
            return worst, told
    return None


def _beyond_doubt(
    step: Step, pairs: Sequence[tuple[np.ndarray, np.ndarray]], noise: np.ndarray
) -> bool:
    """Whether a law takes nearly all off its joint, very far from its noise, by errors without and with it."""
    k = step.added.joint
    return k is not None and all(
        one[k] > LOST * noise[k] and two[k] ** 2 <= (1.0 - LOST_SHARE) * one[k] ** 2
        for one, two in pairs
    )


def proven(
    found: Estimate, left: Sequence[Unexplained], other: Sequence[Motion]
) -> list[Unexplained]:
    """Structure with its smooth terms only where they lower the error on all other motion.

    A function without a law holds where it was fitted; elsewhere it is a guess, and a model without it is
    the better one until another log says otherwise. On a joint near its noise structure that no other log has
    is none: what reversals of a clean wrist left, 1.6 times its noise, seemed to follow two joints.
    """
    near = over_noise(found) <= NEAR
    told = []
    for item in left:
        if item.term is not None:
            model = with_smooth_terms(found, [item])
            pairs = [[rms(log_residual(found, m, x)) for x in (None, model)] for m in other]
            helps = pairs and all(
                (two <= HARM * one).all() and two[item.joint] < GAIN * one[item.joint]
                for one, two in pairs
            )
            if pairs:
                falls = [1.0 - float(two[item.joint] / one[item.joint]) ** 2 for one, two in pairs]
                item = replace(item, elsewhere=min(falls))
                if near[item.joint] and max(falls) <= 0.0:
                    continue
            item = item if helps else replace(item, term=None)
        told.append(item)
    return told
