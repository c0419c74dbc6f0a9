r"""Center and spread of a population of which a few do not belong, from measurements of known variance.

:math:`y_a \sim N(\mu, \tau^2 + v_a)`, a random-effects model. Both are M-estimates (P. J. Huber, Robust
Statistics, 1981, proposal 2): with :math:`r_a = (y_a - \mu) / \sqrt{\tau^2 + v_a}`,

.. math:: \sum_a \psi_c(r_a) / \sqrt{\tau^2 + v_a} = 0, \qquad
          \sum_a \min(r_a^2, c^2) = (A - 1)\, E \min(Z^2, c^2),

the second a bounded form of the moment equation of R. C. Paule and J. Mandel, J. Res. NBS 87 (1982). An arm
that is far off counts as one at c spreads, wherever it is.
"""

from typing import NamedTuple

import numpy as np
from scipy import stats

# Bound of the influence in spreads: up to a third of the arms may be off before the spread gives way.
BOUND = 1.5
# What bounding costs: part of the sample that estimates of normal data are worth, about this.
EFFICIENCY = 0.8
_ROUNDS, _HALVINGS = 8, 40
# Variances below this part of the least known one are none.
_LEAST = 1e-6


class Population(NamedTuple):
    """Center, variance between arms and the center's own variance: one for each of B subsets."""

    center: np.ndarray
    between: np.ndarray
    uncertainty: np.ndarray


def population(values: np.ndarray, variances: np.ndarray, members: np.ndarray) -> Population:
    """Fit subsets of a population.

    Args:
        values: y, (A,).
        variances: v, (A,), positive.
        members: Which arms belong to each subset, (B, A), at least three in each.
    """
    center = np.array([np.median(values[m]) for m in members])
    between = np.zeros(len(members))
    for _ in range(_ROUNDS):
        between = bounded_variance(values[None] - center[:, None], variances, members)
        spread = np.sqrt(between[:, None] + variances)
        size = np.abs(values - center[:, None]) / spread
        weight = members * np.minimum(1.0, BOUND / np.maximum(size, 1e-300)) / spread**2
        center = (weight * values).sum(axis=1) / weight.sum(axis=1)
    precision = (members / (between[:, None] + variances)).sum(axis=1)
    return Population(center, between, 1.0 / (EFFICIENCY * precision))


def bounded_variance(
    deviations: np.ndarray, variances: np.ndarray, members: np.ndarray, lost: float = 1.0
) -> np.ndarray:
    """The variance that deviations have beyond their known ones, (B,): the equation at the head.

    Args:
        deviations: (B, A).
        variances: Known, (A,).
        members: (B, A).
        lost: Degrees of freedom that the center took.
    """
    goal = (members.sum(axis=1) - lost) * expected_bounded_square(BOUND)
    # Below, a variance is nothing beside the known ones; above, every deviation is a small one.
    low = np.full(len(members), _LEAST * variances.min())
    high = 4.0 * np.where(members, deviations**2, 0.0).sum(axis=1) + low

    def too_small(variance: np.ndarray) -> np.ndarray:
        squares = deviations**2 / (variance[:, None] + variances)
        return np.where(members, np.minimum(squares, BOUND**2), 0.0).sum(axis=1) > goal

    none = ~too_small(low)
    for _ in range(_HALVINGS):
        middle = np.sqrt(low * high)
        raise_it = too_small(middle)
        low, high = np.where(raise_it, middle, low), np.where(raise_it, high, middle)
    return np.where(none, 0.0, high)


def expected_bounded_square(bound: float) -> float:
    """E min(Z^2, c^2) of a standard normal variable.

    >>> round(expected_bounded_square(1.5), 3), round(expected_bounded_square(9.0), 3)
    (0.778, 1.0)
    """
    normal = stats.norm
    inside = 2.0 * normal.cdf(bound) - 1.0 - 2.0 * bound * normal.pdf(bound)
    return float(inside + 2.0 * bound**2 * normal.sf(bound))
