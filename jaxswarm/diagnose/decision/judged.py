"""By which joints a law is judged, and whether its coefficients agree with physics."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.decision.rules import CERTAIN
from jaxswarm.diagnose.decision.significance import certainty
from jaxswarm.effects.term import Term


def shows_on_all(term: Term) -> bool:
    """Whether a law has no joint, or shows on all of them, as a wrong zero does."""
    return term.joint is None or not term.law.shows_on_own_joint


def told_on(term: Term, shares: np.ndarray) -> tuple[int, slice]:
    """Where a law shows most, by shares (n,), and the joints by which it is judged.

    A joint effect is a matter of its own joint; others may gain, or lose, through shared parameters, which a
    short log knows badly: a ripple of 94 % of its joint's error drowned in that of five others.
    """
    if shows_on_all(term):
        return int(np.argmax(shares)), slice(None)
    return term.index, slice(term.index, term.index + 1)


def can_be(
    candidate: Candidate,
    found: Sequence[np.ndarray],
    p_value: float,
    blocks: int,
    interval: float,
) -> bool:
    """Whether the coefficients of the halves and of all rows, the last, agree with physics.

    ``p_value``: over so many ``blocks``; ``interval``: of the log's samples [s].
    """
    whole = found[-1]
    doubt = CERTAIN * abs(whole[0]) / max(certainty(p_value, blocks), 1e-9)
    positive = not candidate.positive or all(a[0] > 0 for a in found)
    return bool(positive and candidate.term.law.credible(whole[0], interval, doubt))
