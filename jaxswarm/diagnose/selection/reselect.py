"""Once everything is added, every choice is made again: what one law hid may have misled an earlier one.

An effect was chosen among its competitors while others were still missing. With the others in place, the model
is fitted without it, it and its competitors are asked again, the winner stays, what nobody needs is dropped.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.position_laws import imitates
from jaxswarm.diagnose.decision.competing import (
    choose,
    is_special_case,
    plainness,
    with_soft_joints,
)
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import LOUD, NEAR, Rules
from jaxswarm.diagnose.decision.unexplained import find_unexplained
from jaxswarm.diagnose.decision.worth import Score, passes
from jaxswarm.diagnose.folds.partial_out import CrossFit, cross_fit
from jaxswarm.diagnose.selection.instead import leaves_less, replacement, simpler, surer
from jaxswarm.diagnose.selection.pair import pair
from jaxswarm.diagnose.selection.plainer import plainer
from jaxswarm.diagnose.selection.refit import refit_once
from jaxswarm.diagnose.selection.step import Step, chain, competitors, find_term, with_errors
from jaxswarm.diagnose.selection.tenable import goes_beyond, is_certain
from jaxswarm.effects.alike import has, without
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.logs.motion import Motion


def choose_again(
    steps: Sequence[Step],
    current: Estimate,
    crossfit: CrossFit,
    asked: int,
    rules: Rules,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
    other: Sequence[Motion] = (),
) -> tuple[list[Step], Estimate, bool]:
    """The steps and the model after every choice was made again, and whether one changed.

    Args:
        steps: What was added, in order.
        current: The model with all of it, in which no further candidate passes.
        crossfit: Its folds.
        asked: Candidates asked in the first round, for the level of the tests.
        rules: Thresholds.
        seed: Seed of the searches.
        progress: Called with one line per effect.
        other: Logs of other motion; what changes may not raise the error there.
    """
    if len(steps) > 1 or _doubtful(steps, current) or _perhaps_simpler(steps):
        done, found, changed = reconsider(steps, current, asked, rules, seed, progress, other)
        if changed:
            return done, found, True
        steps = done
    over = over_noise(current)
    acted = {step.score.joint for step in steps}
    far = {j for j in acted if over[j] > NEAR}
    unclear = sorted(j for j in acted - far if over[j] > LOUD)
    left = find_unexplained(current, crossfit, seed, unclear) if unclear else []
    where = sorted(far | {item.joint for item in left})
    if where:
        progress("looking for two laws where one was bent")
        told = pair(steps, current, where, asked, rules, seed)
        if told:
            return (*told, True)
    if (over > LOUD).any():
        return reconsider(steps, current, asked, rules, seed, progress, other, fuller=True)
    return list(steps), current, False


def _doubtful(steps: Sequence[Step], current: Estimate) -> bool:
    """Whether what was added is no longer certain, since clocks were moved, say."""
    known = (with_errors(step.added, current) for step in steps)
    return any(not is_certain(*one) for one in known if one is not None)


def _said_by_less(added: Term, errors: dict[str, float]) -> list[Term]:
    """The laws that an added one contains, where it is no longer certain in what these have not.

    It was when it was added: beside a drive whose gain was 6 % off, a spring explained half of what a cable
    did, and came not near it. Once the gain was there, the cable was a spring and 0.01 +- 0.03 N m/rad from
    the other joint.
    """
    if goes_beyond(added, errors):
        return []
    terms = [Term(name, added.joint) for name in added.law.contains]
    return [t for t in terms if not t.law.everyday]


def _perhaps_simpler(steps: Sequence[Step]) -> bool:
    """Whether a competitor of something added is plainer."""
    return any(plainness(s) < plainness(step.score) for step in steps for s in step.near)


def reconsider(
    steps: Sequence[Step],
    current: Estimate,
    asked: int,
    rules: Rules,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
    other: Sequence[Motion] = (),
    *,
    fuller: bool = False,
) -> tuple[list[Step], Estimate, bool]:
    """Choose every added effect anew among its competitors, the others in place.

    Args:
        steps, current, asked, rules, seed, progress, other: As for :func:`choose_again`.
        fuller: Whether near laws of more numbers are fitted too, where much is left.

    Returns:
        The steps, the model, and whether an effect was exchanged or dropped.
    """
    done, changed = list(steps), False
    freed: set[int | None] = set()
    for step in steps:
        known = with_errors(step.added, current)
        if known is None:
            continue
        rivals = [*competitors(step), *_said_by_less(*known)]
        certain = is_certain(*known)
        if not rivals and certain:
            continue
        progress(f"choosing {step.added.label(current.model.robot.joints)} again")
        rest = refit_once(current, (*without(step.added, current.model.terms), *step.removed))
        crossfit = cross_fit(rest)
        terms = list(dict.fromkeys(replace(t, values={}) for t in (step.added, *rivals)))
        scores = score_terms(Linearization(rest, crossfit), terms, seed)
        passed = _passed(scores, rest, asked, rules)
        place = done.index(step)
        if not passed:
            if _nobody_needs(step, certain, scores, rules):
                del done[place]
                current, changed = rest, True
                freed.add(step.added.joint)
            continue
        chosen, near = choose(passed, rules, crossfit)
        same = chosen.candidate.term.identity == step.added.identity
        picks = _picks(step, chosen, passed)
        instead = replacement(picks, chosen, step.score.candidate.size, rest, current, other, seed)
        if instead is None and same:
            instead = leaves_less(chosen, near, rest, current, other, fuller, seed)
            instead = instead or (None if certain else surer(near, rest, current, other, seed))
        if instead is None:
            if same:
                done[place] = replace(step, rivals=tuple(near))
            continue
        pick, current = instead
        told = (chosen, *near) if pick in passed else ()  # what extends one was compared by its fit
        done[place] = _exchanged(step, pick, told, scores, current, crossfit)
        changed = True
    done, current = _alone(done, freed, current, rules, seed, other)
    return (chain(done) if changed else done), current, changed


def _passed(scores: Sequence[Score], rest: Estimate, asked: int, rules: Rules) -> list[Score]:
    """Those that pass, and imitate nothing that the model has without them."""

    def tested(s: Score) -> bool:
        return passes(s, asked, rules)

    passed = with_soft_joints([s for s in scores if tested(s)], scores, tested)
    return [s for s in passed if not imitates(s.candidate.term, rest.model.terms, rest.motions)]


def _picks(step: Step, chosen: Score, passed: Sequence[Score]) -> list[Score]:
    """What may come in a law's place: the chosen one if it is another, then those that are plainer than it."""
    plain = simpler(step.score, passed)
    if chosen.candidate.term.identity == step.added.identity:
        return plain
    return [chosen, *(s for s in plain if s is not chosen)]


def _alone(
    done: list[Step],
    freed: set[int | None],
    current: Estimate,
    rules: Rules,
    seed: int,
    other: Sequence[Motion],
) -> tuple[list[Step], Estimate]:
    """The steps with plainer laws where one was dropped beside them, and the model."""
    told = []
    for step in done:
        found = None
        if step.added.joint in freed and has(step.added, current.model.terms):
            found = plainer(step.added, current, rules, seed, other)
        if found is not None:
            pick, current = found
            step = _exchanged(step, pick, (), (), current, cross_fit(current))
        told.append(step)
    return told, current


def _exchanged(
    step: Step,
    pick: Score,
    told: Sequence[Score],
    scores: Sequence[Score],
    current: Estimate,
    crossfit: CrossFit,
) -> Step:
    """The step with another law, and of those near the chosen one the rivals that are no special case of it."""
    rivals = tuple(
        s
        for s in told
        if s is not pick and not is_special_case(pick.candidate, s.candidate, crossfit)
    )
    others = tuple(s for s in sorted(scores, key=lambda s: -s.gain) if s is not pick)
    added = find_term(current, pick.candidate.term)
    removed = tuple(t for t in step.removed if not has(t, current.model.terms))
    return replace(step, added=added, score=pick, rivals=rivals, others=others, removed=removed)


def _nobody_needs(step: Step, certain: bool, scores: Sequence[Score], rules: Rules) -> bool:
    """Whether an effect that fails the test goes, and none of its competitors comes in its place.

    What every drive has was added without a test of its own: it has to be certain at least.
    """
    doubtful = step.added.law.everyday and not certain
    return doubtful or all(s.share < rules.share for s in scores)
