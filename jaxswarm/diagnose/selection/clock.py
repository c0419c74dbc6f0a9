"""The clocks of torque and position: a skew below half a sample, allowed for before anything is asked."""

from collections.abc import Sequence

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.significance import certainty
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.identify.estimation.clock_skew import with_clocks, with_skew

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


def settle_clocks(search: Search) -> None:
    """Fit the skew with everything else, once all is added: what was missing before may have moved it."""
    settled = with_clocks(search.current)
    late = settled.motions[0].skew - search.current.motions[0].skew
    if late:
        search.current = with_motion_noise(settled, search.seed)
        search.declared = with_skew(search.declared, late) if search.steps else search.current
        search.crossfit = cross_fit(search.current)


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
