"""How much the rows of a log count in a fit."""

import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.event_rows import event_rows
from jaxswarm.identify.forward.link_lag import slope_terms, unseen_rows
from jaxswarm.logs.motion import Motion


def row_shares(terms: tuple[Term, ...], motion: Motion, number: int) -> np.ndarray:
    """How much a joint's row of a log, by its number, counts, (T', n)."""
    rows = ~event_rows(terms, motion, number) & ~motion.lost_rows
    if slope_terms(terms):
        rows &= ~unseen_rows(motion)
    used = np.repeat(rows[:, None], len(motion.joints), axis=1)
    if motion.held is not None:
        used &= ~motion.held
    return used * (1.0 if motion.loose is None else motion.loose)
