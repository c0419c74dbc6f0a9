"""What else there is of something that was found: further events of its kind, the other end of a cable."""

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.worth import passes
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import step_between
from jaxswarm.effects.term import Term

# Events of one kind that are looked for in a row.
MOST_EVENTS = 20


def add_further(search: Search, asked: Term, most: int) -> None:
    """Add what else is there of something that was found, with nothing else asked.

    Further events of its kind, one after the other; or its other end: a cable over two joints that was found on
    one left the other at 23 times its noise, and bent five laws into it where these were asked first.
    """
    for _ in range(most):
        if search.budget.spent:
            return
        current = search.current
        if asked.identity in {t.identity for t in current.model.terms}:
            return
        lin = Linearization(current, cross_fit(current), search.memory)
        told = score_terms(lin, [asked], search.seed)
        if not told or not passes(told[0], search.asked, search.rules):
            return
        after = refit_with(current, told[0])
        if after is None:
            return
        search.steps.append(step_between(told[0], current, after))
        search.current = after
