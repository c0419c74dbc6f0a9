"""Candidate terms of a model: built with their columns and scored on unseen blocks."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import jax

from jaxswarm import cores
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.propose import propose_all
from jaxswarm.diagnose.decision.score import Score, score
from jaxswarm.diagnose.folds.free_parts import at_once, free_parts
from jaxswarm.effects.term import Term


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
