"""Laws of some joints alone, asked of a fit as they would be among all others."""

from collections.abc import Collection
from dataclasses import replace

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.competing import accepted
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.judged import shows_on_all
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.partial_out import CrossFit, cross_fit
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.identify.estimation.estimate import Estimate


def accepted_on(
    search: Search, found: Estimate, joints: Collection[int], memory: Memory
) -> tuple[list[Score], CrossFit]:
    """Laws that would be added to a fit and show on some joints or on the whole arm, and its folds.

    A law that shows on its own joint says nothing of others: asked of all seven, those of one took five times
    as long. The level is that of a test among all.
    """
    every, folds = eligible_terms(found.model, found.motions), cross_fit(found)
    terms = [t for t in every if shows_on_all(t) or t.joint in joints]
    among = search.rules.significance * len(terms) / max(len(every), 1)
    scores = score_terms(Linearization(found, folds, memory), terms, search.seed)
    passed = accepted(scores, replace(search.rules, significance=among), search.added)
    return [s for s in passed if s.joint in joints or s.candidate.term.joint is None], folds
