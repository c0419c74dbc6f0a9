"""The clocks of torque and position: a skew below half a sample, allowed for before anything is asked."""

from collections.abc import Sequence

from jaxswarm.diagnose.decision.rules import CERTAIN
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.identify.estimation.clock_skew import (
    clock_skew,
    credited,
    with_clocks,
    with_skew,
)
from jaxswarm.identify.estimation.least_squares import weighted_cost
from jaxswarm.identify.estimation.time_slopes import CERTAIN_CLOCK
from jaxswarm.identify.estimation.weight_clock import weight_step

# How often the skew is found anew.
_MOST_SKEWS = 3
# A skew [s] below this moves a torque at 10 Hz by a thousandth of its size.
_LEAST_SKEW = 2e-5


def allow_for_skew(search: Search, eligible: Sequence[Term]) -> bool:
    """Move the clocks against each other where they are apart; whether they were moved.

    A delay below half a sample is a matter of the clock, not of the robot, and so always allowed for: every
    sampled and held torque is early or late by a part of a sample. What is surely more is left to be told.
    """
    clocks = [t.law for t in of_kind(eligible, MeasurementLaw) if t.law.clock]
    if len(search.skews) == _MOST_SKEWS or not clocks:
        return False
    intervals = [m.interval for m in search.current.motions]
    heavy = weight_step(search.current)
    late, doubt = clock_skew(search.current, heavy)
    if any(law.credible(late, max(intervals), CERTAIN * doubt) for law in clocks):
        return False
    known = search.current.motions[0].skew
    late = credited(known + late, doubt, min(intervals)) - known
    if abs(late) <= _LEAST_SKEW and not heavy:
        return False
    search.skews.append(late)
    moved, sigma = with_skew(search.current, late, heavy), search.current.fit.sigma
    before, after = (weighted_cost(e.fit.residual, sigma) for e in (search.current, moved))
    if after > before and abs(late) <= CERTAIN_CLOCK * doubt:
        return False
    search.current = moved
    # The error before is told by the same clocks as the error after.
    search.declared = with_skew(search.declared, late, heavy) if search.steps else search.current
    return True


def settle_clocks(search: Search) -> None:
    """Fit the skew with everything else, once all is added: what was missing before may have moved it."""
    settled = with_clocks(search.current)
    before, after = (e.motions[0] for e in (search.current, settled))
    late, heavy = after.skew - before.skew, after.weight_skew - before.weight_skew
    if late or heavy:
        search.current = with_motion_noise(settled, search.seed)
        search.declared = (
            with_skew(search.declared, late, heavy) if search.steps else search.current
        )
        search.crossfit = cross_fit(search.current)
