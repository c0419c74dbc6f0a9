"""Why an addition may not stay once nothing more is added."""

import numpy as np

from jaxswarm.diagnose.decision.level import reads_otherwise
from jaxswarm.diagnose.decision.own_variables import left_of_own
from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import (
    A_THIRD,
    BENT_TOLD_BY_SHARE,
    CERTAIN,
    CERTAIN_ALONE,
    FAR_LESS,
    FOLLOWS_OWN,
    HARM,
    LOST,
    MORE_THAN_NOISE,
    NEAR,
    OF_SEVERAL,
    OF_TAKEN,
    OF_TAKEN_NEAR,
    STRUCTURE,
    TOLD_BY_SHARE,
)
from jaxswarm.diagnose.decision.unexplained import find_unexplained
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.doubt_of_motion import fall_without_noise, is_spring
from jaxswarm.diagnose.selection.elsewhere import errors_elsewhere
from jaxswarm.diagnose.selection.plainer import does_as_well, numbers_of
from jaxswarm.diagnose.selection.refit import refit_once, share_left
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import Step, find_term, terms_before, with_errors
from jaxswarm.diagnose.selection.survives import survives
from jaxswarm.diagnose.selection.tenable import is_certain
from jaxswarm.effects.alike import has
from jaxswarm.identify.estimation.estimate import Estimate

_NO_OTHER_LOG = "no other log shows it: record another motion and pass it with --validation"


def standing(search: Search) -> list[Step]:
    """The additions that the model has: a later one may have taken an earlier one's place, a lag a delay's."""
    return [step for step in search.steps if has(step.added, search.current.model.terms)]


def model_without(current: Estimate, step: Step) -> Estimate:
    """The model without an addition, and with what it took the place of."""
    return refit_once(current, terms_before(step, current.model.terms))


def _why_not(search: Search, step: Step) -> str | None:
    """Why an addition does not survive beside all the others; None if it does."""
    current, joint = search.current, step.score.joint
    return survives(model_without(current, step), current, joint, search.other, search.rules)


def idle(search: Search) -> tuple[Step, str] | None:
    """The first addition of no certain number that no other log shows, and why; None if none is.

    One that takes nearly all off its joint is told from nothing by that: a spring on a lever, which is little
    but the weight of its link, was 2.0 standard errors from none; without it squares are a hundredfold.

    Held-out time of the log that it was found in shows none that its numbers do not: of seven such additions
    on several hundred logs six were false, and the true one had another log. A coupling of 0.01 +- 0.03
    N m s/rad took half off the squares of held-out blocks, beside noise with a memory as long as these.
    """
    current = search.current
    least = CERTAIN if search.other else CERTAIN_ALONE
    for step in standing(search):
        law, known = step.added.law, with_errors(step.added, current)
        if law.in_one_log or law.everyday or known is None or is_certain(*known, least):
            continue
        why = _why_not(search, step) if search.other else _unshown(current, step)
        if why:
            return step, f"is not told from nothing, or hardly, and {why}"
    return None


def nothing(search: Search) -> tuple[Step, str] | None:
    """The first addition of which bounds leave nothing, and why; None if there is none.

    Friction by a power of the speed wanted to be below zero beside a push of 18 s, and stood in the report as
    0.0 +- 1.7 N m.
    """
    for step in standing(search):
        term = find_term(search.current, step.added)
        linear = () if term.law.everyday else term.law.linear
        if linear and not any(term.values[p.name] for p in linear):
            return step, "comes to nothing within its bounds"
    return None


def raises_its_own(search: Search) -> tuple[Step, str] | None:
    """The first addition with which its own joint's error is larger on another log, and why; None if none is.

    Of another joint that has to be no chance of a few stretches (:func:`harmful`); of its own it is the law
    that has to be shown. Friction at places, told as one by the position at the bound of its orders, lowered it
    as long as rows were fitted in which the joint stuck, and raised it from 11.6 to 13.4 N m without these.
    """
    for step in standing(search):
        j, law = step.score.joint, step.added.law
        if law.in_one_log or law.everyday:
            continue
        for one, two, falls, _, where in errors_elsewhere(
            model_without(search.current, step), search.current, search.other
        ):
            if not falls[j] and two[j] > HARM * one[j]:
                name = search.current.model.robot.joints[j]
                return step, f"raises the error of {name} {where} from {one[j]:.3g} to {two[j]:.3g}"
    return None


def _unshown(current: Estimate, step: Step) -> str | None:
    """Why an addition needs another log; None where it takes enough off its joint."""
    law = step.added.law
    share = BENT_TOLD_BY_SHARE if law.linear and law.nonlinear else TOLD_BY_SHARE
    left = share_left(current, model_without(current, step))[step.score.joint]
    return None if left < 1.0 - share else _NO_OTHER_LOG


def outdone(search: Search) -> tuple[Step, str] | None:
    """The first addition in the place of one that it extends, and no better any more, and why; None if none is.

    Beside rows in which friction holds joints, elements that slip took the place of bristles; without these
    rows they left 1.4 times as much of held-out time, and stood in the report with that. Nor is one that leaves
    no less than what it contains, as friction of each direction does whose halves have become one.
    """
    for step in standing(search):
        law, current = step.added.law, search.current
        asked = set(law.contains) - set(law.extends)
        inner = [t for t in step.removed if t.effect in asked]
        if inner:
            saved = numbers_of(find_term(current, step.added))
            saved -= sum(len(t.law.parameters) for t in step.removed)
            if saved > 0 and does_as_well(model_without(current, step), current, saved):
                names = " and ".join(t.effect for t in inner)
                return step, f"leaves no less than {names} any more"
        plain = [
            t.effect
            for t in step.removed
            if t.effect in law.extends and not reads_otherwise(law, t.effect)
        ]
        if not plain:
            continue
        why = _why_not(search, step)
        if why:
            return step, f"is no better than {plain[0]} any more: {why}"
    return None


def of_noise(search: Search) -> tuple[Step, str] | None:
    """The first spring that filters noise of the positions and shows no link, and why; None if none does.

    Asked are those without which their joint is near that noise.
    """
    current = search.current
    for step in standing(search):
        joint = step.score.joint
        if not is_spring(step.added):
            continue
        rest = model_without(current, step)
        near = over_noise(rest)[joint] < NEAR
        if near and fall_without_noise(rest, current, joint, search.seed) < MORE_THAN_NOISE:
            return (
                step,
                "filters the noise of the positions: with more of it, it takes off as much more",
            )
    return None


def stand_in(search: Search) -> tuple[Step, str] | None:
    """The addition of whose own variables most is left, and why it is no name; None if none is.

    A ripple of which more orders were found may have others. Very far from the noise one alone, beside which no
    further order helps, is none where it left a fair part of its joint: a detent at one place was told as one.
    """
    current, left, told = search.current, over_noise(search.current), []
    for step in standing(search):
        term = find_term(current, step.added)
        law, joint = term.law, term.joint
        if law.in_one_log or law.everyday or joint is None:
            continue
        orders = [s for s in search.steps if (s.added.effect, s.added.joint) == (law.name, joint)]
        if law.several and (left[joint] < LOST or len(orders) > 1):
            continue
        share, p_value = left_of_own(current, search.folds, term, search.seed)
        # Near the noise it takes as sure a proof as that of the law itself.
        tests = max(1, search.asked) if left[joint] < NEAR else 1
        if share < STRUCTURE or p_value * tests > search.rules.significance:
            continue
        leaves = share_left(current, model_without(current, step))[joint]
        if _other_form(left[joint], share, leaves) and (not law.several or leaves > OF_SEVERAL):
            told.append((share, joint, step))
    if not told:
        return None
    share, joint, step = max(told, key=lambda item: item[0])
    part = f"leaves {left[joint]:.1f} times the noise on {current.model.robot.joints[joint]}"
    return (
        step,
        f"{part}, {100 * share:.0f} % of it by what it is about itself: a law of another form",
    )


def _other_form(left: float, share: float, leaves: float) -> bool:
    """Whether a law that leaves so much over the noise, a share of it by its own variables, has another form.

    ``leaves``: the part of its joint's squared error without it that it leaves.
    """
    if left < NEAR:
        return share * leaves > OF_TAKEN_NEAR**2 * (1.0 - leaves)
    return share >= FOLLOWS_OWN and left * np.sqrt(share) >= NEAR and leaves > OF_TAKEN**2


def poor(search: Search) -> tuple[Step, str] | None:
    """The first addition instead of which a smooth function leaves far less, and why; None if none is."""
    current, left = search.current, over_noise(search.current)
    for step in standing(search):
        law, joint = step.added.law, step.added.joint
        if law.in_one_log or law.everyday or joint is None or left[joint] < NEAR:
            continue
        rest = model_without(current, step)
        leaves = share_left(current, rest)[joint]
        if leaves < A_THIRD:
            continue
        smooth = find_unexplained(rest, cross_fit(rest), search.seed, [joint])
        if smooth and 1.0 - smooth[0].share < FAR_LESS * leaves:
            names = " and ".join(smooth[0].depends_on)
            part = f"takes {100 * (1.0 - leaves):.0f} % off the squared error of"
            told = f"{part} {current.model.robot.joints[joint]}, a function of {names}"
            return step, f"{told} {100 * smooth[0].share:.0f} %"
    return None
