r"""What changed on one arm over its logs: the slope of every parameter over time.

Weighted least squares of :math:`y_k = \alpha + \beta t_k`, weights :math:`1 / (s_k^2 + w^2)` with the scatter w
of logs of one arm over the whole fleet (:mod:`jaxswarm.fleet.mixed_model`): one arm has too few logs to tell
its own. Without that scatter standard errors alone would take every change of motion for one of the arm.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import stats

from jaxswarm.fleet.mixed_model import FALSE_DISCOVERIES, LEAST_STEPS, Series, controlled, scatter


class Drift(NamedTuple):
    """A parameter of an arm over time.

    Attributes:
        arm: Its name.
        parameter: Its name.
        logs: Number of logs.
        begin, end: Values that the line has at the first and the last log.
        change: The difference; std_error: of it.
        days: Time between them [d].
        p_value: Of a change as large by chance.
        q_value: Least rate of false discoveries at which it is told.
    """

    arm: str
    parameter: str
    logs: int
    begin: float
    end: float
    change: float
    std_error: float
    days: float
    p_value: float
    q_value: float = np.nan

    @property
    def drifts(self) -> bool:
        """Whether the change is told."""
        return self.q_value <= FALSE_DISCOVERIES


def drifts(series: Sequence[Series]) -> list[Drift]:
    """The change of every parameter of every arm with logs of two days, false discoveries controlled."""
    return controlled([one for each in series for one in _of_parameter(each)])


def _of_parameter(series: Series) -> list[Drift]:
    extra, steps = scatter(series)
    if steps < LEAST_STEPS:
        return []
    found, arms = [], np.asarray(series.arms, dtype=object).astype(str)
    for arm in np.unique(arms):
        own = (arms == arm) & np.isfinite(series.days)
        days, values = series.days[own], series.values[own]
        if own.sum() < 2 or np.ptp(days) == 0.0:
            continue
        weight = 1.0 / (series.errors[own] ** 2 + extra)
        middle = np.average(days, weights=weight)
        power = (weight * (days - middle) ** 2).sum()
        slope = (weight * (days - middle) * values).sum() / power
        span, mean = np.ptp(days), np.average(values, weights=weight)
        error = span / np.sqrt(power)
        chance = 2.0 * stats.t.sf(abs(slope * span) / max(error, 1e-300), steps)
        begin, end = (mean + slope * (day - middle) for day in (days.min(), days.max()))
        numbers = map(float, (begin, end, slope * span, error, span, chance))
        found.append(Drift(str(arm), series.parameter, int(own.sum()), *numbers))
    return found
