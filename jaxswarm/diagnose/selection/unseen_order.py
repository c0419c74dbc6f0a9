"""A law that fits clearly worse than waves of which no whole period is seen names nothing.

Such waves are a bend, which any law of the position has, so that they are no name themselves. But what leaves
clearly more than they do is not what the joint has either: a ripple that was seen through 0.72 of a period was
told as a gravity compensator that left 0.019 N m, where the ripple leaves 0.0075. Neither is added then; what
is told is that the log does not tell the two apart, and how far the joint has to move to show a whole period.
"""

from jaxswarm.diagnose.candidates.position_laws import period
from jaxswarm.diagnose.decision.competing import beats
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.selection.diagnosis import Outdone
from jaxswarm.diagnose.selection.plainer import does_as_well
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.identify.estimation.estimate import Estimate

_WORSE = (
    "leaves clearly more than {} does, of which no whole period is seen: move the joint further"
)


def worse_than_waves(search: Search, chosen: Score, after: Estimate) -> str | None:
    """Why a law is no name for what waves explain that were refused as they are hardly seen; None if it may be.

    The waves have to explain what the law leaves, and the law nothing of what they leave; and where they spend
    more numbers, these have to pay once both are fitted.

    Args:
        search: The selection, with the model without it and the waves that were refused beside that.
        chosen: The law.
        after: The fit with it.
    """
    waves = search.unseen.get(chosen.candidate.term.joint)
    if waves is None or not beats(waves, chosen, search.rules, search.folds):
        return None
    fitted = refit_with(search.current, waves)
    saved = waves.candidate.size - chosen.candidate.size
    if fitted is None or does_as_well(after, fitted, saved):
        return None
    law, better = find_term(after, chosen.candidate.term), find_term(fitted, waves.candidate.term)
    search.outdone.append(Outdone(law, better, period(better)))
    return _WORSE.format(waves.candidate.term.effect)
