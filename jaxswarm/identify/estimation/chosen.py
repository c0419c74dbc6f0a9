"""Values that a term begins with: those that it has, what a log says of its choices, and usual ones."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.term import Term
from jaxswarm.logs.motion import Motion


def with_values_to_begin(terms: Sequence[Term], motions: Sequence[Motion]) -> tuple[Term, ...]:
    """The terms with a value of each nonlinear parameter; those that they have stay.

    Args:
        terms: Laws on joints.
        motions: Prepared logs with torque [N m or N].
    """
    return tuple(
        replace(t, values={**{p.name: _begin(p, t, motions) for p in t.law.nonlinear}, **t.values})
        for t in terms
    )


def _begin(parameter: Parameter, term: Term, motions: Sequence[Motion]) -> float:
    if parameter.lies != "torque":
        return parameter.nominal
    # As the fit sees them: a sample that jumps is no torque of the joint.
    seen = (m.decimator.apply(m.tau[:, term.index]) for m in motions if m.tau is not None)
    largest = max(float(np.nanmax(np.abs(tau))) for tau in seen)
    return float(np.clip(largest, parameter.lower, parameter.upper))
