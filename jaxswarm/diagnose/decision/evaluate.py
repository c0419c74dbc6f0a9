"""Candidate terms of a model: built with their columns and scored on unseen blocks."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import jax

from jaxswarm import cores
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.propose import propose_all
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.score import score
from jaxswarm.diagnose.decision.worth import Score, passes
from jaxswarm.diagnose.folds.free_parts import at_once, free_parts
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate


def score_terms(
    lin: Linearization,
    terms: Sequence[Term],
    seed: int,
    signed: Callable[[Term], bool] = lambda term: False,
) -> list[Score]:
    """Scores of candidates against a model.

    Args:
        lin: The model, linearized.
        terms: Terms to ask.
        seed: Seed of the searches.
        signed: Whether a term is a change of something known, of either sign.
    """
    interval = max(m.interval for m in lin.found.motions)
    candidates = propose_all(lin, tuple(terms), jax.random.key(seed))
    told = [replace(c, signed=signed(c.term)) for c in candidates]

    def scored(part: slice) -> list[Score]:
        some = told[part]
        parts = free_parts([c.columns for c in some], lin.crossfit)
        pairs = zip(some, parts, strict=True)
        return [score(c, lin.crossfit, interval, free) for c, free in pairs]

    together = at_once([c.columns for c in told])
    scores = [one for some in cores.each(scored, together) for one in some]
    for one in scores:
        lin.memory.explained(one.candidate.term, one.trained)
    return scores


def score_on(found: Estimate, terms: Sequence[Term], seed: int) -> list[Score]:
    """Scores of candidates against a fit that is looked at for them alone."""
    return score_terms(Linearization(found, cross_fit(found)), terms, seed)


def score_if_passing(
    found: Estimate, term: Term, asked: int, rules: Rules, seed: int
) -> Score | None:
    """The score of one term, without its values, on a fit if it passes at the level of ``asked`` candidates."""
    scores = score_on(found, [replace(term, values={})], seed)
    return next((s for s in scores if passes(s, asked, rules)), None)
