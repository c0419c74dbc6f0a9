"""One law of the whole arm in the place of what was added on its joints, or of a joint in that of several.

A body carried for a while takes ten numbers and a window, and a wrong zero shows on all joints. Half a short
log knows them so badly that they fail for chance, given how many are asked, while a law of a joint takes a
part of the same with one number or two: of a payload of 33 g in a log of 10 s, a drag and a cable were told,
which left 1.2 and 1.4 times the noise where the payload leaves 0.6. That something is missing is proven once
a law was added; which one is another question, to which the fits to the whole log are an answer, as for any
rivals of different size.

So it is on one joint: of a drive whose gain is 3 % off, in point-to-point motion of 10 s, a saturation and a
cable were told, whose eighteen standard errors the gain had as well but not in every block. Alone it leaves as
little.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.decision.evaluate import score_on
from jaxswarm.diagnose.decision.judged import shows_on_all
from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import ASKED_ALONE, FAR_MORE, LOUD, NEAR, PRICE
from jaxswarm.diagnose.decision.worth import Score, passes
from jaxswarm.diagnose.selection.plainer import cost, does_as_well
from jaxswarm.diagnose.selection.refit import refit, refit_with
from jaxswarm.diagnose.selection.rivals_elsewhere import no_worse
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import Step, chain, step_between
from jaxswarm.diagnose.selection.survives import survives
from jaxswarm.effects.alike import lacking
from jaxswarm.identify.estimation.estimate import Estimate


def one_for_several(search: Search) -> bool:
    """Put one law in the place of several, or of those of joints, if it explains as much; whether it did.

    What every drive has stays.
    """
    if search.budget.spent:
        return False
    return _one_of_the_arm(search) or _one_of_a_joint(search)


def _one_of_the_arm(search: Search) -> bool:
    """Put a law of the whole arm in the place of all that was added, if it explains more; whether it did."""
    added = [k for k, step in enumerate(search.steps) if not step.added.law.everyday]
    if not added or not (over_noise(search.current) > LOUD).any():
        return False
    kept, steps = search.steps[: added[0]], search.steps[added[0] :]
    if any(shows_on_all(step.added) for step in steps):
        return False
    before = steps[0].before
    for score in _asked_alone(search, before, None, steps[0].score.worth):
        after = refit_with(before, score)
        if after is None or not _explains_more(search, steps, score, after):
            continue
        _replace(search, steps, [*kept, step_between(score, before, after)])
        return True
    return False


def _one_of_a_joint(search: Search) -> bool:
    """Put one law of a joint in the place of several there, if it leaves as little; whether it did.

    In that of what every drive has, too, where that alone was not enough: friction by a power of the speed was
    told as viscous, dry and Stribeck friction, of which the last one was taken back for its uncertain numbers.
    """
    current, other = search.current, search.other
    for steps in _of_joints(search.steps):
        joint, rest = steps[0].added.index, [s for s in search.steps if s not in steps]
        before = refit(current, lacking(current.model.terms, [s.added for s in steps]))
        numbers = sum(s.score.candidate.size for s in steps)
        for score in _asked_alone(search, before, joint):
            saved = numbers - score.candidate.size
            may = saved > 0 and not _leaves_far_more(score, before, current)
            after = refit_with(before, score) if may else None
            if after is None or not does_as_well(after, current, saved):
                continue
            if not no_worse(after, current, joint, other):
                continue
            if survives(before, after, joint, other, search.rules) is None:
                _replace(search, steps, chain([*rest, step_between(score, before, after)]))
                return True
    return False


def _leaves_far_more(score: Score, before: Estimate, several: Estimate) -> bool:
    """Whether a law leaves far more of its joint to first order than a fit with several others does."""
    left = cost(several, score.joint, several) / cost(before, score.joint, several)
    return 1.0 - score.trained > FAR_MORE * left


def _of_joints(steps: Sequence[Step]) -> Iterator[list[Step]]:
    """Several additions of a joint: laws that not every drive has, then those with what every drive has."""
    lasting = [s for s in steps if s.added.joint is not None and _lasts(s)]
    for joint in dict.fromkeys(s.added.joint for s in lasting):
        own = [s for s in lasting if s.added.joint == joint]
        special = [s for s in own if not s.added.law.everyday]
        if len(special) > 1:
            yield special
        if special and len(own) > len(special):
            yield own


def _lasts(step: Step) -> bool:
    """Whether a step added a law that is there all the time."""
    law = step.added.law
    return not (law.recurring or law.in_one_log or step.removed)


def _replace(search: Search, gone: Sequence[Step], steps: list[Step]) -> None:
    """Go on with steps of which the last one took the place of others."""
    search.current = steps[-1].after
    told = steps[-1].added.label(search.current.model.robot.joints)
    search.progress(f"{told} in place of what was added")
    search.withdrawn += tuple(s.added for s in gone)
    search.steps = steps
    search.ask_again(None)  # what was refused was refused beside laws that are gone


def _asked_alone(
    search: Search, before: Estimate, joint: int | None, least: float = 0.0
) -> list[Score]:
    """Laws of a joint, or of the arm, that gain more than the least and would pass alone, the best first.

    They pass as if nobody else were asked, at the usual level: what decides is what they leave.
    """
    refused = {term.identity for term, _ in search.refused} | search.barred
    terms = [
        t
        for t in eligible_terms(before.model, before.motions)
        if (shows_on_all(t) if joint is None else t.joint == joint)
        and not (t.law.recurring or t.law.everyday)
        and t.identity not in refused
    ]
    rules = replace(search.rules, significance=ASKED_ALONE)
    told = [
        s for s in score_on(before, terms, search.seed) if s.gain > least and passes(s, 1, rules)
    ]
    return sorted(told, key=lambda s: -s.gain)


def _explains_more(search: Search, steps: Sequence[Step], score: Score, after: Estimate) -> bool:
    """Whether a fit leaves every joint near its noise, and less than the present one by more than it costs.

    No joint that had a law of its own may be left with more, here or on other motion.
    """
    current, joints = search.current, {step.score.joint for step in steps}
    more = score.candidate.size - sum(step.score.candidate.size for step in steps)
    if (over_noise(after) > NEAR).any() or does_as_well(current, after, more):
        return False
    if any(cost(after, j, current) > PRICE * cost(current, j, current) for j in joints):
        return False
    if not all(no_worse(after, current, j, search.other) for j in joints):
        return False
    if score.candidate.term.law.in_one_log:
        return True
    return not survives(steps[0].before, after, score.joint, search.other, search.rules)
