"""What a window of time is worth as an event."""

import numpy as np
import scipy

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.contact import loudest
from jaxswarm.diagnose.decision.rules import MOST_TAKEN, OTHERS, SELECTED
from jaxswarm.diagnose.decision.significance import stands_out
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.free_parts import coefficients
from jaxswarm.diagnose.folds.partial_out import CrossFit
from jaxswarm.identify.estimation.covariance import correlation_length


def score_event(candidate: Candidate, crossfit: CrossFit, free: np.ndarray) -> Score:
    """The score of an event: no other time can tell, so that it has to stand out by itself.

    Neither it nor what a few other windows show is error of which it takes a share, or memory of the noise that
    it is told against. The share is that of the squared torque, not bounded as in the gain: the few samples of
    an event are what the bounds are made against.
    """
    whole, weight = crossfit.whole, crossfit.weight
    inside: np.ndarray = np.any(candidate.columns[0], axis=(1, 2))
    timing = crossfit.timing
    free, residual = free * timing[:, :, None], whole.residual * timing
    a = coefficients(free, whole, residual)
    predicted = free @ a
    fall = residual**2 - (residual - predicted) ** 2
    left = residual - predicted
    pushes = weight * timing * ~inside[:, None]
    others = loudest(pushes, left, crossfit.log, OTHERS, stands_out)
    if others.any():  # what they did to the fit is no memory either
        quiet = ~(inside | others)
        left = whole.trained_on(quiet).residual * timing * quiet[:, None]
    raw = np.divide(1.0, weight**2, where=weight > 0, out=np.zeros_like(weight))
    shares = (fall * raw).sum(axis=0) / np.maximum((residual**2 * raw)[~others].sum(axis=0), 1e-300)
    joint, per_joint = int(np.argmax(shares)), fall.sum(axis=0)
    gain = float(per_joint.sum())
    memory = correlation_length(left, crossfit.log)
    windows = len(residual) / max(int(inside.sum()), 1)
    blocks = np.bincount(crossfit.block, fall.sum(axis=1))
    acting = np.any(candidate.columns[0], axis=0).sum(axis=1)
    chance = windows * chance_of(per_joint / memory / SELECTED, acting)
    dense = stands_out(float(shares[joint]), 1.0 / windows)
    return Score(
        candidate=candidate,
        gain=gain,
        per_joint=per_joint,
        blocks=blocks,
        share=float(shares[joint]),
        trained=float(shares[joint]),
        joint=joint,
        p_value=float(min(1.0, chance)),
        repeats=1.0,
        coefficients=a,
        allowed=dense and inside.mean() <= MOST_TAKEN,
    )


def chance_of(squares: np.ndarray, acting: np.ndarray) -> float:
    """Chance that noise falls by such squares (n,) in one window, on all joints together or on one of them.

    What pushes the arm may show on one joint alone, beside which the noise of five others hides it: a second
    push of 30 times the noise for 0.4 s was refused among 280 candidates, at p = 9e-5, and is told at 1e-6.

    Args:
        squares: Fall of the squared error of each joint, in those of its noise.
        acting: Numbers of the event that act on each joint, (n,).
    """
    together = scipy.special.chdtrc(len(squares), max(float(squares.sum()), 0.0))
    alone = scipy.special.chdtrc(np.maximum(acting, 1), np.maximum(squares, 0.0)).min()
    # The better one of two, and the best one of all joints.
    return 2.0 * float(min(together, len(squares) * alone))
