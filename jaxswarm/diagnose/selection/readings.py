"""One effect that two laws of as few numbers read otherwise: a torque that is late by a clock, or by a filter.

Below its corner a filter is late as a clock is, so that it is found as a delay first and asked beside that.
What it has to show there is no effect of its own but which of both it is: which leaves less, each with its
one number. Of fourteen filters of 8 to 26 ms, whose torque was 2.2 to 3.3 times the noise, six were told as
delays: beside a delay they took too little off for an effect, though 4.6 to 13 standard errors.
"""

from dataclasses import replace

from jaxswarm.diagnose.decision.evaluate import score_on
from jaxswarm.diagnose.decision.level import reads_otherwise
from jaxswarm.diagnose.decision.rules import GAIN
from jaxswarm.diagnose.decision.worth import Score, is_large
from jaxswarm.diagnose.selection.plainer import does_as_well
from jaxswarm.diagnose.selection.refit import refit_in_place
from jaxswarm.diagnose.selection.rivals_elsewhere import no_worse
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import Step, find_term
from jaxswarm.diagnose.selection.survives import survives
from jaxswarm.effects import REGISTRY
from jaxswarm.effects.alike import has
from jaxswarm.effects.base import Effect
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate


def why_not(search: Search, chosen: Score, after: Estimate) -> str | None:
    """Why a law that was fitted is not added, nothing where that is not worth telling; None if it is.

    Args:
        search: The selection, with the model without it.
        chosen: The law.
        after: The fit with it.
    """
    current, term = search.current, find_term(after, chosen.candidate.term)
    if _is_read_otherwise(term, current):
        holds = no_worse(after, current, chosen.joint, search.other)
        return None if holds and not does_as_well(current, after, 1) else ""
    if not is_large(chosen, search.rules):
        return ""
    if term.law.in_one_log:
        return None
    return survives(current, after, chosen.joint, search.other, search.rules)


def with_readings(search: Search) -> None:
    """Tell what was added as undecided from a law that reads it otherwise and does as well, once fitted."""
    search.steps = [_with_readings(search, step) for step in search.steps]


def _with_readings(search: Search, step: Step) -> Step:
    current, added = search.current, step.added
    if not has(added, current.model.terms):
        return step
    told = [s.candidate.term.effect for s in step.rivals]
    laws = [
        law
        for law in REGISTRY.values()
        if reads_otherwise(law, added.effect) and law.name not in told
    ]
    rivals = [
        score
        for law in laws
        if _does_as_well(search, step, law)
        for score in score_on(step.before, [Term(law.name, added.joint)], search.seed)
    ]
    return replace(step, rivals=(*step.rivals, *rivals)) if rivals else step


def _does_as_well(search: Search, step: Step, law: Effect) -> bool:
    """Whether the model with a law in the place of an addition leaves as little, here and on other motion."""
    current, start = search.current, law.neutral() | dict(law.probe)
    term = Term(law.name, step.added.joint, values=start)
    after = refit_in_place(current, term)
    if not _is_read_otherwise(find_term(after, term), current) or not does_as_well(
        after, current, 1
    ):
        return False
    return no_worse(after, current, step.score.joint, search.other, 1.0 / GAIN)


def _is_read_otherwise(term: Term, current: Estimate) -> bool:
    """Whether a fitted law has none of what a model has instead, and so as few numbers."""
    return any(
        t.joint == term.joint
        and reads_otherwise(term.law, t.effect)
        and all(term.values[p.name] == p.nominal for p in term.law.parameters if p.usual)
        for t in current.model.terms
    )
