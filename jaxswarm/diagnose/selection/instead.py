"""Which of the laws that came near each other is told, once each is fitted with all that was added."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.decision.competing import plainness
from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import AT_MOST_HALF, NEAR, PRICE
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.selection.extended import extended
from jaxswarm.diagnose.selection.plainer import cost, does_as_well
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.rivals_elsewhere import no_worse
from jaxswarm.diagnose.selection.step import with_errors
from jaxswarm.diagnose.selection.tenable import is_certain
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.logs.motion import Motion


def fitted_pick(rest: Estimate, pick: Score, seed: int) -> tuple[Score, Estimate] | None:
    """A law fitted, or what extends it where that leaves less by more than its numbers cost."""
    after = refit_with(rest, pick)
    return None if after is None else (extended(pick, after, seed) or (pick, after))


def replacement(
    picks: Sequence[Score],
    chosen: Score,
    size: int,
    rest: Estimate,
    current: Estimate,
    other: Sequence[Motion],
    seed: int = 0,
) -> tuple[Score, Estimate] | None:
    """The first pick that may stand in the current model's place, with its fit; None if none may.

    The chosen law itself may leave about what the former one, of ``size`` numbers, left on its joint; of more
    numbers it has to leave less by more than they cost, as one that is simpler has to do as well: viscous
    friction was told as a power of the speed of 0.94 +- 0.04. None may raise the error of other motion.
    """
    for pick in picks:
        found = fitted_pick(rest, pick, seed)
        if found is None:
            continue
        more, after = found[0].candidate.size - size, found[1]
        if pick is chosen:
            worth = more <= 0 or not does_as_well(current, after, more)
            fits = worth and cost(after, pick.joint, rest) <= PRICE * cost(
                current, pick.joint, rest
            )
        else:
            fits = does_as_well(after, current, -more)
        if fits and no_worse(after, current, pick.joint, other):
            return found
    return None


def leaves_less(
    chosen: Score,
    near: Sequence[Score],
    rest: Estimate,
    current: Estimate,
    other: Sequence[Motion],
    more: bool,
    seed: int = 0,
) -> tuple[Score, Estimate] | None:
    """A law as good as the chosen one on its joint that, all fitted, leaves less by more than its numbers cost.

    A cable between two joints and a spring explain the same of one of them; what the cable does to the other
    shows only when the first is explained. Of a soft joint and a soft base, of two numbers each, the plainer by
    form was told and left a tenth more. ``more``: whether laws of more numbers are asked.
    """
    size, most = chosen.candidate.size, np.inf if more else chosen.candidate.size
    for pick in (s for s in near if size <= s.candidate.size <= most):
        found = fitted_pick(rest, pick, seed)
        if found is None or does_as_well(current, found[1], found[0].candidate.size - size):
            continue
        if no_worse(found[1], current, pick.joint, other):
            return found
    return None


def far_less(
    chosen: Score, rivals: Sequence[Score], after: Estimate, current: Estimate
) -> tuple[Score, Estimate, list[Score]]:
    """The law to add, its fit, and the others: a rival that leaves far less once fitted, where much is left.

    What a law gains beside a model that stands still says little where it moves all of that: beside a base that
    swings its tilt gained 0.9 of what a sensor did that picks up the next joint, and fitted it left a third of
    what that left. In its place a contact made up for the rest.

    Args:
        chosen, after: The law that gains most, and the fit with it.
        rivals: Those that the log does not tell from it.
        current: The model without any of them.
    """
    asked = [s for s in rivals if not s.candidate.term.law.recurring]
    if (over_noise(after) < NEAR).all():
        asked = []
    fits = [(s, refit_with(current, s)) for s in asked]
    told = [(s, fit, cost(fit, slice(None), current)) for s, fit in fits if fit is not None]
    best = min(told, key=lambda one: one[2], default=None)
    if best is None or best[2] > AT_MOST_HALF * cost(after, slice(None), current):
        return chosen, after, list(rivals)
    return best[0], best[1], [s for s in (chosen, *rivals) if s is not best[0]]


def surer(
    near: Sequence[Score], rest: Estimate, current: Estimate, other: Sequence[Motion], seed: int = 0
) -> tuple[Score, Estimate] | None:
    """A law that the data do not tell from the current model's and whose numbers, unlike its own, are certain.

    It may leave little more. Beside a bound of a rotor an encoder's zero of 0.019 +- 0.011 rad did what a cable
    of the next joint does by -6.1 +- 0.9 N m, had the fewer numbers, and doubled the error of other motion.
    """
    for pick in near:
        found = fitted_pick(rest, pick, seed)
        known = None if found is None else with_errors(found[0].candidate.term, found[1])
        if found is None or known is None or not is_certain(*known):
            continue
        left = cost(found[1], pick.joint, rest) <= PRICE * cost(current, pick.joint, rest)
        if left and no_worse(found[1], current, pick.joint, other):
            return found
    return None


def simpler(chosen: Score, passed: Sequence[Score]) -> list[Score]:
    """Those that are plainer, the plainest first.

    While a law is tried the others stay as they were fitted without it, and one with a free exponent
    makes up for that. Fitted all together, the simpler law may do: a spring was told as a cubic one.
    """
    fewer = [s for s in passed if plainness(s) < plainness(chosen)]
    return sorted(fewer, key=lambda s: (plainness(s), -s.gain))
