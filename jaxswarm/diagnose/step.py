"""One round of the loop that added something."""

from dataclasses import dataclass

from jaxswarm.diagnose.decide import Score
from jaxswarm.identify.estimate import Estimate
from jaxswarm.identify.terms import Term


@dataclass(frozen=True)
class Step:
    """An added effect with the evidence for it.

    Attributes:
        added: The term, with the values of the fit after it.
        score: What it was worth.
        rivals: Terms the data did not tell from it.
        others: Scores of the runners-up on the same joint.
        before, after: The estimates around it.
        removed: Terms that became superfluous.
    """

    added: Term
    score: Score
    rivals: tuple[Score, ...]
    others: tuple[Score, ...]
    before: Estimate
    after: Estimate
    removed: tuple[Term, ...]
