"""What else there is of something that was found: further events of its kind, the other end of a cable."""

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.worth import Score, passes
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.stand import events_of_laws
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import step_between
from jaxswarm.effects.term import Term

# Events of one kind that are looked for in a row.
MOST_EVENTS = 20


def add_further(search: Search, asked: Term, most: int) -> None:
    """Add what else is there of something that was found, with nothing else asked.

    Further events of its kind, one after the other; or its other end: a cable over two joints that was found on
    one left the other at 23 times its noise, and bent five laws into it where these were asked first. The level
    is divided by the looks there may be: a third push of 0.3 s was told at p = 4e-5, and refused as one of 280.
    """
    for _ in range(most):
        if search.budget.spent:
            return
        current = search.current
        if asked.identity in {t.identity for t in current.model.terms}:
            return
        lin = Linearization(current, cross_fit(current), search.memory)
        told = score_terms(lin, [asked], search.seed)
        if not told or not passes(told[0], most, search.rules):
            return
        if asked.law.recurring and _is_of_a_law(told[0], search, lin):
            return
        after = refit_with(current, told[0])
        if after is None:
            return
        search.steps.append(step_between(told[0], current, after))
        search.current = after


def _is_of_a_law(event: Score, search: Search, lin: Linearization) -> bool:
    """Whether a law of the event's joint, which was asked before the first event was added, tells it.

    Friction that fell while a drive warmed up was told as five pushes, up and down with its joint's direction,
    since a true push was there and no law was asked until all of them were found.
    """
    asked = [
        s.candidate.term
        for s in search.scores
        if s.joint == event.joint
        and s.share >= search.rules.share
        and not s.candidate.term.law.in_one_log
    ]
    laws = score_terms(lin, asked, search.seed) if asked else []
    return bool(events_of_laws(laws, [event], lin.crossfit, search.rules))
