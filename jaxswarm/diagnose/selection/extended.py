"""A transmission judged by the fit of what extends it.

A gear that stiffens as it winds up is looked for where a straight spring was found, and a straight spring fits
it badly: on one arm it left as much as an eccentric encoder, which was told, where the other one, fitted, left
half of that. To first order about the straight one it is not seen: it took 15 % off its joint's squared error,
and 45 % off that of all once it was fitted. So the fits decide.
"""

from dataclasses import replace

from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.decision.evaluate import score_on
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.selection.plainer import does_as_well
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.effects.kinds import TransmissionLaw
from jaxswarm.identify.estimation.estimate import Estimate


def extended(chosen: Score, after: Estimate, seed: int) -> tuple[Score, Estimate] | None:
    """What extends a transmission and leaves less by more than its numbers cost, with its fit; else None.

    Args:
        chosen: The score of the transmission, which is the evidence for what takes its place too.
        after: The fit with it.
        seed: Seed of the searches.
    """
    term = chosen.candidate.term
    if not isinstance(term.law, TransmissionLaw):
        return None
    asked = [
        t
        for t in eligible_terms(after.model, after.motions)
        if t.joint == term.joint and term.effect in t.law.extends
    ]
    for score in score_on(after, asked, seed):
        further = refit_with(after, score)
        more = score.candidate.size - chosen.candidate.size
        if further is not None and not does_as_well(after, further, more):
            own = replace(chosen.candidate, term=score.candidate.term, size=score.candidate.size)
            return replace(chosen, candidate=own), further
    return None
