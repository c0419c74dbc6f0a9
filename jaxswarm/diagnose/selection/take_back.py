"""What is taken back once nothing more is added: what does harm, and what stands for something else."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.decision.own_variables import left_of_own
from jaxswarm.diagnose.decision.rules import (
    A_THIRD,
    FAR_LESS,
    FOLLOWS_OWN,
    LOST,
    LOST_SHARE,
    NEAR,
    OF_TAKEN,
    OF_TAKEN_NEAR,
    STRUCTURE,
)
from jaxswarm.diagnose.decision.unexplained import find_unexplained
from jaxswarm.diagnose.folds.noise import noise_of, with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.refit import refit, share_left
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.state_events import event_of_nothing, event_of_state, time_of_state
from jaxswarm.diagnose.selection.step import Step, chain, find_term, with_errors
from jaxswarm.diagnose.selection.survives import harmful, survives
from jaxswarm.diagnose.selection.tenable import is_certain
from jaxswarm.diagnose.selection.unpredicted import unpredicted
from jaxswarm.effects.alike import has, without
from jaxswarm.identify.estimation.estimate import Estimate


def take_back(search: Search) -> bool:
    """Take back what may not stay; whether a law may now be found that one of these had kept out.

    A stop was told as a cubic spring, beside which no spring with a dead zone may stand, and the cubic spring
    was taken back as a law of another form: a residual of 59 times the noise, which the other one explains.
    """
    before = list(search.steps)
    take_back_harm(search)
    take_back_events(search)
    take_back_shadows(search)
    take_back_stand_ins(search)
    gone = [s.added for s in before if not any(s.added is t.added for t in search.steps)]
    again = {t.joint for t in gone} & search.kept_out
    search.kept_out -= again
    search.barred |= {replace(t, values={}).identity for t in gone if t.joint in again}
    search.banned = {key for key in search.banned if key[1] not in again}
    search.settled = search.settled and not again
    return bool(again)


def take_back_harm(search: Search) -> None:
    """Take back, one after the other, what in the end raises a joint's error on other motion or other time."""

    def wrong() -> tuple[Step, str] | None:
        told = search.declared, search.steps, search.current
        return harmful(*told, search.other) or (None if search.other else unpredicted(*told))

    _take_back(search, wrong)


def take_back_idle(search: Search) -> bool:
    """Take back what is not told from nothing once clocks and widths are settled, and proves itself no more.

    Whether anything was.

    Beside clocks and widths of a worse minimum a drive's dead band of -9.1 +- 0.8 N m took half of its joint's
    squared error; beside those of the final fit it was -0.7 +- 0.7 N m, and stood in the headline.
    """
    held = len(search.steps)
    _take_back(search, lambda: _idle(search))
    return len(search.steps) < held


def take_back_events(search: Search) -> None:
    """Take back events that nothing is left to, and what a function of the arm's motion predicts as well."""
    _take_back(search, lambda: event_of_nothing(search))
    _take_back(search, lambda: event_of_state(search) or time_of_state(search), events=True)


def take_back_shadows(search: Search) -> None:
    """Take back what explains a small part of what its joint lacks, where the rest stays far above the noise.

    What is missing there has no name, and what goes along with a part of it has no better one: an encoder's
    eccentricity took a fifth off what another joint had left, an eighth off its own, which a soft gear left at
    5.6 times the noise (q10). The part is that which a law has to take off the joint where it shows most, and
    nearly all where what is left is very far above the noise. What lowers the error of another log is shown.
    """
    if not search.other:
        _take_back(search, lambda: _shadow(search))


def take_back_stand_ins(search: Search) -> None:
    """Take back what leaves a function of what its own law is about: far above the noise little else, near it
    much beside what it took.

    It has the place and the variable of what is missing, not its form: a cushion at the end of the travel was
    told as a spring with a dead zone, friction by the partner's direction as a coupling of velocities. A ripple
    may have more orders than were found, and beside everyday friction there may be any other. What a law leaves
    that is small beside what it took is a detail of it. Nor is one left that leaves a third of what a smooth
    function explains nearly all of: two bumps were told as a ripple.
    """
    held = len(search.steps)
    _take_back(search, lambda: _stand_in(search), events=True)
    _take_back(search, lambda: _poor(search), events=True)
    if len(search.steps) < held:
        # What a law hid shows now: four contacts of one joint stood beside a cable that was taken off another.
        take_back_events(search)


def _take_back(
    search: Search, wrong: Callable[[], tuple[Step, str] | None], events: bool = False
) -> None:
    """Take back what is wrong, with the reason, until nothing is; ``events`` of its joint with it."""
    while search.steps:
        found = wrong()
        if found is None:
            break
        step, why = found
        search.refuse(step.added, why)
        kept, terms = [], search.current.model.terms
        for one in search.steps:
            if one is step or _goes_with(one, step, events):
                terms = without(one.added, terms) if has(one.added, terms) else terms
            else:
                kept.append(one)
        search.current = with_motion_noise(refit(search.current, terms), search.seed)
        search.steps = chain(kept) if kept else []
        search.crossfit = cross_fit(search.current)


def _standing(search: Search) -> list[Step]:
    """The additions that the model has: a later one may have taken an earlier one's place, a lag a delay's."""
    return [step for step in search.steps if has(step.added, search.current.model.terms)]


def _goes_with(one: Step, step: Step, events: bool) -> bool:
    """Whether an addition is the other end of another one's law, or an event found beside it on its joint.

    Beside a spring that stood in for a cushion two contacts were told at the ends of the travel.
    """
    a, b = one.added, step.added
    joint = step.score.joint if b.joint is None else b.joint
    ends = a.law.mutual and (a.effect, a.joint, a.other) == (b.effect, b.other, b.joint)
    return ends or (events and a.law.in_one_log and one.score.joint == joint)


def _without(current: Estimate, step: Step) -> Estimate:
    """The model without an addition."""
    return refit(current, without(step.added, current.model.terms))


def _over_noise(current: Estimate) -> np.ndarray:
    """What is left on every joint over its noise, (n,)."""
    return current.fit.sigma / noise_of(current)


def _idle(search: Search) -> tuple[Step, str] | None:
    """The first addition of no certain number that does not survive any more, and why; None if none is."""
    current = search.current
    for step in _standing(search):
        law, known = step.added.law, with_errors(step.added, current)
        if law.in_one_log or law.everyday or known is None or is_certain(*known):
            continue
        rest = _without(current, step)
        why = survives(rest, current, step.score.joint, search.other, search.rules)
        if why:
            return step, f"is not told from nothing any more, and {why}"
    return None


def _shadow(search: Search) -> tuple[Step, str] | None:
    """The addition that takes least off its joint's error, if it is such, and why; None if none is."""
    current, left = search.current, _over_noise(search.current)
    told = []
    for step in _standing(search):
        law = step.added.law
        acts = {step.score.joint, step.added.joint}
        far = [j for j in acts if j is not None and left[j] > NEAR]
        if law.in_one_log or law.everyday or not far:
            continue
        leaves = share_left(current, _without(current, step))
        for j in far:
            lost = left[j] > LOST and not law.several
            told.append((1.0 - leaves[j], LOST_SHARE if lost else search.rules.share, j, step))
    told = [item for item in told if item[0] < item[1]]
    if not told:
        return None
    share, _, joint, step = min(told, key=lambda item: item[0])
    name = current.model.robot.joints[joint]
    part = f"takes {100 * share:.0f} % off the squared error of {name}"
    return step, f"{part}, which stays {left[joint]:.1f} times its noise"


def _stand_in(search: Search) -> tuple[Step, str] | None:
    """The addition of whose own variables most is left, and why it is no name; None if none is."""
    current, left, told = search.current, _over_noise(search.current), []
    for step in _standing(search):
        term = find_term(current, step.added)
        law, joint = term.law, term.joint
        if law.in_one_log or law.everyday or law.several or joint is None:
            continue
        share, p_value = left_of_own(current, search.folds, term, search.seed)
        # Near the noise it takes as sure a proof as that of the law itself.
        tests = max(1, search.asked) if left[joint] < NEAR else 1
        if share < STRUCTURE or p_value * tests > search.rules.significance:
            continue
        leaves = share_left(current, _without(current, step))[joint]
        if _other_form(left[joint], share, leaves):
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


def _poor(search: Search) -> tuple[Step, str] | None:
    """The first addition instead of which a smooth function leaves far less, and why; None if none is."""
    current, left = search.current, _over_noise(search.current)
    for step in _standing(search):
        law, joint = step.added.law, step.added.joint
        if law.in_one_log or law.everyday or joint is None or left[joint] < NEAR:
            continue
        rest = _without(current, step)
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
