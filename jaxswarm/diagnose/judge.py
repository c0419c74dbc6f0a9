"""Suspects put to a model: gathered with their columns and scored on unseen blocks."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import jax

from jaxswarm.diagnose.background import Background
from jaxswarm.diagnose.decide import Score, score
from jaxswarm.diagnose.gather import gather
from jaxswarm.diagnose.stand import Memory, Stand
from jaxswarm.identify.estimate import Estimate
from jaxswarm.identify.terms import Term


def judge(
    found: Estimate,
    background: Background,
    suspects: Sequence[Term],
    seed: int,
    memory: Memory | None = None,
    signed: Callable[[Term], bool] = lambda term: False,
) -> list[Score]:
    """Scores of suspects against a model.

    Args:
        found: The model.
        background: Its stage.
        suspects: Terms to ask.
        seed: Seed of the searches.
        memory: Spares searches between rounds; None: nothing is remembered.
        signed: Whether a term is a change of something known, of either sign.
    """
    stand = Stand(found, background, memory)
    interval = max(m.interval for m in found.motions)
    candidates = gather(stand, tuple(suspects), jax.random.key(seed))
    return [score(replace(c, signed=signed(c.term)), background, interval) for c in candidates]
