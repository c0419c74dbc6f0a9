r"""Arms that differ from their sisters: a mixed model of every parameter over logs and arms.

.. math:: y_{ak} = \mu + b_a + \varepsilon_{ak}, \qquad b_a \sim N(0, \tau^2), \qquad
          \varepsilon_{ak} \sim N(0, s_{ak}^2 + w^2).

:math:`s_{ak}` is the standard error of a log; :math:`w` is what logs of one arm scatter beyond it, from the
steps between neighbors in time. Each arm is measured against the others alone, so that it does not hide
itself: :math:`t_a = (\bar y_a - \mu_{-a}) / \sqrt{\tau_{-a}^2 + v_a + var(\mu_{-a})}`, by Student's
distribution. Of all arms and parameters together those are told that Y. Benjamini and Y. Hochberg, J. R.
Statist. Soc. B 57 (1995), let pass. Reference: J. C. Pinheiro, D. M. Bates, Mixed-Effects Models (2000).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import stats

from jaxswarm.fleet.robust import EFFICIENCY, bounded_variance, population

# Of those arms that are told, this share may be told by chance.
FALSE_DISCOVERIES = 0.05
# Fewer arms tell no spread by which another one could be measured.
LEAST_ARMS = 5
# Fewer steps between logs of one arm tell no scatter.
LEAST_STEPS = 5
# Among more arms than this one more or less does not move center and spread.
_MANY = 300


class Deviation(NamedTuple):
    """One parameter of one arm beside those of the others.

    Attributes:
        arm: Its name.
        parameter: Its name.
        value: Mean over the arm's logs; std_error: of it, without the spread between arms.
        center: Of the others; spread: standard deviation between them.
        p_value: Of a difference as large by chance.
        q_value: Least rate of false discoveries at which it is told.
    """

    arm: str
    parameter: str
    value: float
    std_error: float
    center: float
    spread: float
    p_value: float
    q_value: float = np.nan

    @property
    def differs(self) -> bool:
        """Whether the arm is told to differ."""
        return self.q_value <= FALSE_DISCOVERIES


class Series(NamedTuple):
    """One parameter over the logs of all arms, those of one arm in order of time.

    Attributes:
        parameter: Its name.
        arms: Name of the arm of every log.
        values, errors: (N,) values and standard errors.
        days: (N,) time [d]; NaN where it is not known.
    """

    parameter: str
    arms: Sequence[str]
    values: np.ndarray
    errors: np.ndarray
    days: np.ndarray


def scatter(series: Series) -> tuple[float, int]:
    """Variance w^2 of logs of one arm beyond their standard errors, and the number of steps it is from."""
    same = np.array([a == b for a, b in zip(series.arms[:-1], series.arms[1:], strict=True)], bool)
    step, count = np.diff(series.values)[same], int(same.sum())
    if count < LEAST_STEPS:
        return 0.0, count
    known = (series.errors[:-1] ** 2 + series.errors[1:] ** 2)[same]
    extra = bounded_variance(step[None], known, np.ones((1, count), bool), lost=0.0)
    return 0.5 * float(extra[0]), count


def deviations(series: Sequence[Series]) -> list[Deviation]:
    """Every arm's every parameter beside those of the others, false discoveries controlled over all."""
    found = [one for each in series for one in _of_parameter(each)]
    return controlled(found)


def controlled(found: list) -> list:
    """Tuples with a ``p_value``, their ``q_value`` set by Benjamini and Hochberg over all of them."""
    if not found:
        return []
    chances = stats.false_discovery_control([one.p_value for one in found], method="bh")
    return [one._replace(q_value=float(q)) for one, q in zip(found, chances, strict=True)]


def _of_parameter(series: Series) -> list[Deviation]:
    arms, means, variances = _by_arm(series)
    count = len(arms)
    if count < LEAST_ARMS:
        return []
    if count <= _MANY:
        others = population(means, variances, ~np.eye(count, dtype=bool))
        center, between, doubt = others
        others_count = count - 1
    else:
        whole = population(means, variances, np.ones((1, count), bool))
        center, between, doubt = (np.repeat(x, count) for x in whole)
        others_count = count
    size = (means - center) / np.sqrt(between + variances + doubt)
    chance = 2.0 * stats.t.sf(np.abs(size), EFFICIENCY * (others_count - 1))
    rows = zip(arms, means, np.sqrt(variances), center, np.sqrt(between), chance, strict=True)
    return [Deviation(arm, series.parameter, *map(float, numbers)) for arm, *numbers in rows]


def _by_arm(series: Series) -> tuple[list[str], np.ndarray, np.ndarray]:
    """Names, weighted means and their variances."""
    extra, _ = scatter(series)
    names, arm = np.unique(np.asarray(series.arms, dtype=object).astype(str), return_inverse=True)
    weight = 1.0 / (series.errors**2 + extra)
    total = np.bincount(arm, weight)
    return list(names), np.bincount(arm, weight * series.values) / total, 1.0 / total
