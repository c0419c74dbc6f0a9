"""The noise of rows with what dry friction may hold in some of them: a law that shows there alone is none."""

import numpy as np

from jaxswarm.diagnose.folds.noise import row_noise
from jaxswarm.diagnose.folds.stiction import reversal_noise
from jaxswarm.identify.estimation.estimate import Estimate


def beside_rest(found: Estimate) -> np.ndarray:
    """Noise of every row, (T', n), with any torque within its friction where a joint hardly moves."""
    if any(m.event_noise is None for m in found.motions):
        return row_noise(found)
    more = np.concatenate([m.event_noise for m in found.motions if m.event_noise is not None])
    return np.hypot(row_noise(found), more)


def beside_reversals(found: Estimate) -> np.ndarray:
    """The same with that where a joint reverses, for however short a time."""
    more = np.concatenate([reversal_noise(found.model, m) for m in found.motions])
    return np.hypot(beside_rest(found), more)
