"""Candidate terms of a model: built with their columns and scored on unseen blocks."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import jax

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.propose import propose_all
from jaxswarm.diagnose.decision.score import Score, score
from jaxswarm.effects.term import Term


def score_terms(
    lin: Linearization,
    terms: Sequence[Term],
    seed: int,
    signed: Callable[[Term], bool] = lambda term: False,
) -> list[Score]:
    """Scores of candidates against a model.

    Candidates that came to nothing in an earlier round, and cannot have come to more by now, keep the columns
    of that round.

    Args:
        lin: The model, linearized.
        terms: Terms to ask.
        seed: Seed of the searches.
        signed: Whether a term is a change of something known, of either sign.
    """
    interval = max(m.interval for m in lin.found.motions)
    memory, weight = lin.memory, lin.crossfit.weight

    def scored(candidates: Sequence[Candidate]) -> dict[tuple, Score]:
        changes = (replace(c, signed=signed(c.term)) for c in candidates)
        return {c.term.place: score(c, lin.crossfit, interval) for c in changes}

    told = [t for t in terms if _on_own_joint(t)]
    old = [memory.slight(t, lin.residuals(t.joint), weight) for t in told]
    found = {p: s for p, s in scored([c for c in old if c]).items() if memory.is_slight(s.trained)}
    asked = [t for t in terms if t.place not in found]
    fresh = scored(propose_all(lin, tuple(asked), jax.random.key(seed)))
    for term in asked:
        one = fresh.get(term.place)
        if one is None:
            continue
        memory.explained(one.candidate.term, one.trained)
        if _on_own_joint(term):
            memory.keep_slight(one.candidate, one.trained, lin.residuals(term.joint), weight)
    found |= fresh
    return [found[t.place] for t in terms if t.place in found]


def _on_own_joint(term: Term) -> bool:
    """Whether a term is told by its own joint's residual, whatever the others have, and by all of it."""
    law = term.law
    return term.joint is not None and law.shows_on_own_joint and not law.in_one_log
