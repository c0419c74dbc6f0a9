"""How surely a candidate's slope is above zero, what a p-value is worth, and how much a part of a whole is."""

import numpy as np
import scipy

from jaxswarm.diagnose.decision.rules import DENSE, WEIGHTY


def certainty(p_value: float, blocks: int) -> float:
    """Standard errors by which a slope is above zero, of its one-sided p-value over so many blocks.

    The inverse of :func:`slope_p_value`, by the same distribution. A normal one gives the same p-value at half
    as many: a delay of 0.7 samples was above zero by 13.9 over 20 blocks, was taken for one that is so by 6.7,
    and so might have been below half a sample.

    >>> round(certainty(1e-11, 20), 1)
    13.9
    """
    return float(-scipy.special.stdtrit(blocks - 1, max(p_value, 1e-300)))


def slope_p_value(inner: np.ndarray, square: np.ndarray) -> float:
    """One-sided p-value of a positive slope from sums over blocks, by the jackknife.

    Args:
        inner: Sum of prediction times residual of every block, (B,).
        square: Sum of squared predictions of every block, (B,).

    >>> slope_p_value(np.array([1.0, 1.1, 0.9, 1.0]), np.ones(4)) < 1e-3
    True
    >>> slope_p_value(np.array([4.0, 0.0, 0.0, 0.0]), np.array([4.0, 0.1, 0.1, 0.1])) > 0.1
    True
    """
    count, total = len(inner), square.sum()
    rest = total - square
    if total <= 0 or (rest <= 1e-9 * total).any():
        return 1.0
    slopes = (inner.sum() - inner) / rest
    spread = np.sqrt((count - 1) / count * ((slopes - slopes.mean()) ** 2).sum())
    return float(scipy.special.stdtr(count - 1, -inner.sum() / total / max(spread, 1e-300)))


def no_more_than(
    size: np.ndarray, inner: np.ndarray, square: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Sums over blocks as if no prediction were larger than what it predicts.

    The fit to the other blocks may know little of a motion that one block alone holds: of a base that gives
    way it predicted ten times the squares that were there, on one joint of one block in twenty, beside which
    what was right about all others might have been chance (p = 0.04). Which way such a prediction points
    counts, and no more.

    Args:
        size: Sum of squared residuals of every block, (B, ...).
        inner: Sum of prediction times residual, (B, ...).
        square: Sum of squared predictions, (B, ...).

    >>> no_more_than(np.array([4.0, 4.0]), np.array([3.0, 8.0]), np.array([4.0, 64.0]))
    (array([3., 2.]), array([4., 4.]))
    """
    times = np.sqrt(np.minimum(1.0, size / np.maximum(square, 1e-300)))
    return times * inner, times**2 * square


def helped(gains: np.ndarray) -> float:
    """Share of the blocks whose gain (B,) counts in which something is gained.

    >>> helped(np.array([3.0, -1.0, 2.0, 0.01]))
    0.6666666666666666
    """
    weighty = np.abs(gains) > WEIGHTY * abs(gains.mean())
    return float((gains[weighty] > 0).mean()) if weighty.any() else 0.0


def stands_out(share: float, time: float) -> bool:
    """Whether a share of the squared error in a share of time is an event: much in little, or nearly all.

    >>> stands_out(0.5, 0.1), stands_out(0.5, 0.2), stands_out(0.9, 0.4), stands_out(0.9, 0.7)
    (True, False, True, False)
    """
    return share >= DENSE * time or 1.0 - share <= (1.0 - time) / DENSE


def share_of(predicted: np.ndarray, residual: np.ndarray) -> float:
    """Largest share of a joint's squared residual (T, n) that a prediction takes off."""
    before = np.maximum((residual**2).sum(axis=0), 1e-300)
    return float(max(0.0, (1.0 - ((residual - predicted) ** 2).sum(axis=0) / before).max()))
