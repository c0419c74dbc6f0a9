"""Events of which no end is seen: what begins in a log and lasts until that is over, on one joint, is a jump.

Whoever pushes an arm lets go again. A torque's zero that jumped 4.5 s before a log of 15 s was over, all of 4.7
times its noise, was told as a contact until the last sample: no block of the log tells a jump from another one,
so that its chance was 1.3 % among all that were asked, while the event is told against other times. Both say
the same of the log, the jump with two numbers less, and another log without the contact was left at 3.3 N m
for 0.4.
"""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.decision.rules import AS_GOOD
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.effects.kinds import ExternalTorque
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.written_down import clock_lag


def jumps_for_events(
    passed: Sequence[Score], scores: Sequence[Score], found: Estimate
) -> list[Score]:
    """Those that passed, with a law that begins for good in the place of an event that says no more.

    Args:
        passed: Candidates that may be added.
        scores: All candidates.
        found: The model without them.
    """
    told = [_jump_for(one, scores, found) or one for one in passed]
    return list(dict.fromkeys(told))


def _jump_for(event: Score, scores: Sequence[Score], found: Estimate) -> Score | None:
    """The law that says what an event without an end says, the best one first; None if there is none."""
    if not isinstance(event.candidate.term.law, ExternalTorque):
        return None
    if not _has_no_end(event, found) or not _is_of_one(event):
        return None
    laws = [
        s
        for s in scores
        if s.candidate.term.law.begins
        and s.candidate.term.joint == s.joint == event.joint
        and s.allowed
        and s.trained >= AS_GOOD * event.trained
    ]
    return max(laws, key=lambda s: s.trained, default=None)


def _has_no_end(event: Score, found: Estimate) -> bool:
    """Whether an event ends with its log, as far as that is fitted."""
    values = event.candidate.term.values
    rows = found.regression.log == values["log"]
    last = found.regression.t[rows].max() - clock_lag(found.model.terms)
    return bool(values["end"] > last)


def _is_of_one(event: Score) -> bool:
    """Whether an event has no torque above the noise but on one joint."""
    columns = event.candidate.columns[0]
    torque = np.abs(columns @ event.coefficients).max(axis=0)
    return bool((np.delete(torque, event.joint) <= 1.0).all())
