"""The clocks of torque and position: a skew below half a sample, allowed for before anything is asked."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.score import certainty
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.identify.estimation.estimate import Estimate, estimate
from jaxswarm.logs.motion import shift_motion

# How often the skew is found anew.
_MOST_SKEWS = 3
# A skew [s] below this moves a torque at 10 Hz by a thousandth of its size.
_LEAST_SKEW = 2e-5


def allow_for_skew(search: Search, lin: Linearization, eligible: Sequence[Term]) -> bool:
    """Move the clocks against each other where they are apart; whether they were moved."""
    if len(search.skews) == _MOST_SKEWS:
        return False
    late = clock_skew(lin, eligible, search.seed)
    if abs(late) > min(m.interval for m in search.current.motions):
        return False  # not surely a delay, and too much for a clock
    if abs(late) <= _LEAST_SKEW:
        return False
    search.skews.append(late)
    search.current = with_skew(search.current, late)
    # The error before is told by the same clocks as the error after.
    search.declared = with_skew(search.declared, late) if search.steps else search.current
    return True


def clock_skew(lin: Linearization, terms: Sequence[Term], seed: int) -> float:
    """A delay [s] below half a sample: a matter of the clock, not of the robot, and so always allowed for.

    Every sampled and held torque is early or late by a part of a sample. The estimate is shrunk by its own
    certainty, the positive-part rule of W. James and C. Stein (1961): nothing where there is nothing.
    """
    for s in score_terms(lin, [t for t in of_kind(terms, MeasurementLaw) if t.law.clock], seed):
        if not s.allowed and s.gain > 0:
            shrunk = max(0.0, 1.0 - 1.0 / max(certainty(s.p_value), 1e-9) ** 2)
            return float(s.coefficients[0]) * shrunk
    return 0.0


def with_skew(current: Estimate, seconds: float) -> Estimate:
    """The same model fitted to logs whose motion is moved against the torque."""
    motions = tuple(shift_motion(m, seconds) for m in current.motions)
    return estimate(
        current.model.robot,
        current.model.terms,
        motions,
        bounded=False,
        start=np.asarray(current.model.robot.parameters).ravel(),
    )
