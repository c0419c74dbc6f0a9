"""What can be had at best: the mechanism itself, its constants fitted to the log beside the arm's.

A model that is told the mechanism's torque to the last digit knows more than any fit could find out. This one
knows the form alone; what a found formula leaves beyond it is form, what it leaves beyond the other constants.
"""

from copy import copy

import numpy as np
import scipy

from benchmarks.mechanism_cases import Hidden, Prepared
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.identify.estimation.estimate import Estimate

# Steps of the fit, which starts at the truth: the distance is that of an error bar.
_STEPS = 30


def fitted(case: Prepared, told: Estimate) -> Hidden:
    """The mechanism of a case as its log tells it.

    Args:
        case: A case that hides one.
        told: The model of the log without the mechanism's torque.
    """
    hidden, motion, crossfit = case.hidden, told.motions[0], cross_fit(told)
    assert hidden is not None
    names = [name for name, value in hidden.values.items() if isinstance(value, float)]
    start = np.array([hidden.values[name] for name in names])

    def at(values: np.ndarray) -> Hidden:
        one = copy(hidden)
        one.values = hidden.values | dict(zip(names, map(float, values), strict=True))
        return one

    def free(one: Hidden) -> np.ndarray:
        own = motion.decimator.apply(one.torque(motion.q, motion.dq))
        return crossfit.whole.free_part(crossfit.weigh(own[:, :, None])).ravel()

    target = crossfit.whole.residual.ravel() + free(hidden)

    def size(column: np.ndarray) -> float:
        return float(column @ target) / max(float(column @ column), 1e-300)

    def left(values: np.ndarray) -> np.ndarray:
        column = free(at(values))
        return target - size(column) * column

    if names:
        scale = np.maximum(np.abs(start), 0.1)
        start = scipy.optimize.least_squares(left, start, x_scale=scale, max_nfev=_STEPS).x
    best = at(start)
    best.size *= size(free(best))
    return best
