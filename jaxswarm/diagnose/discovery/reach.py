"""How a formula goes on where the joint was not: what explodes there is no law, however well it fits inside.

A law is read beyond the range it was seen in as soon as the arm moves otherwise. A spring grows by powers of
the way, drag by powers of the speed; products of powers and exponentials that follow one flank of a force to
the end of the range grow by hundreds right behind it, and a force of nature does not.
"""

import numpy as np

from jaxswarm.diagnose.discovery.problem import Joint
from jaxswarm.diagnose.discovery.sums import Sum
from jaxswarm.effects.postfix import evaluate

# The range of every variable is doubled; what a term may grow by in it: 32 is a fifth power, 12 the steepest
# exponential that is searched, and their product is beyond it.
_WIDER, _MOST_GROWTH = 2.0, 40.0
# What has no range of its own, or no range that another motion leaves.
_BOUNDED = ("direction", "t", "temperature")


def tame(problem: Joint, formula: Sum) -> bool:
    """Whether no term of a formula explodes behind the ranges of its variables."""
    wider = {
        name: x if name in _BOUNDED else np.median(x) + _WIDER * (x - np.median(x))
        for name, x in problem.data.items()
    }
    return all(_growth(problem, formula, wider, p) <= _MOST_GROWTH for p in formula.programs)


def _growth(problem: Joint, formula: Sum, wider: dict, program) -> float:
    """Largest torque of a term in the wider ranges over that in those of the data."""
    with np.errstate(all="ignore"):
        inside, beyond = (
            np.abs(evaluate(program, {**data, **formula.values}, np)).max()
            for data in (problem.data, wider)
        )
        growth = beyond / inside
    return float(growth) if np.isfinite(growth) else np.inf
