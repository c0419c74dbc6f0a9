"""Fitting a model with other terms from where the current one stands."""

from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.decision.rules import IN_PLACE, WITHIN_BOUNDS
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.noise import row_weight
from jaxswarm.diagnose.selection.holds import holds
from jaxswarm.diagnose.selection.refit_starts import from_inside, starts, with_start
from jaxswarm.diagnose.selection.tenable import (
    can_be,
    unphysical_beside,
    winds_up,
    within_chance,
)
from jaxswarm.diagnose.selection.within_bounds import within_own_bounds
from jaxswarm.effects.alike import lacking, number_of
from jaxswarm.effects.term import Term, valued
from jaxswarm.identify.estimation.estimate import Estimate, estimate
from jaxswarm.identify.estimation.free_parameters import Place
from jaxswarm.identify.estimation.gauss_newton import settle
from jaxswarm.identify.estimation.least_squares import weighted_cost
from jaxswarm.identify.estimation.problem import Problem
from jaxswarm.identify.estimation.sign_width import best_widths
from jaxswarm.identify.forward.columns import is_kept
from jaxswarm.identify.forward.finite_columns import Diverged
from jaxswarm.identify.forward.written_down import clock_lag

# The logarithm of a width's ratio below which a fit is trusted to have found it by itself.
_NEAR = 0.3
# Square of the standard errors from which on other widths are told: they are the best of a dozen, one of which
# is that far by chance in 5 % (0.4 % each).
_TOLD = 8.2


def refit_with(current: Estimate, chosen: Score, beyond: bool = True) -> Estimate | None:
    """The estimate with one more term, without those it contains; None if the cost does not fall, a
    coefficient leaves its physical bounds or the torque leaves the finite numbers.

    ``beyond``: whether the term has to be certain, and in what those that it contains have not.

    Where it comes to nothing beside terms that it may replace, it is fitted without these, and has to take
    nearly as much off its joint's error as it promised beside them. From there they are asked once more.
    """
    law, joint = chosen.candidate.term.law, chosen.joint
    after = _refit_without(current, chosen, law.contains, beyond)
    if after is not None or not law.replaces:
        return after
    after = _refit_without(current, chosen, law.contains + law.replaces, beyond)
    if after is None:
        return None
    one, two = (left_on(e, joint) for e in (current, after))
    return _put_back(current, after) if 1.0 - two / one >= IN_PLACE * chosen.share else None


def _put_back(current: Estimate, after: Estimate) -> Estimate:
    """The fit with the terms that its last one replaced beside it again, where they can be.

    A fit from afar may run past the law it looks for: a power of the speed beside viscous friction went to
    the exponent 1.02, two large numbers of opposite sign, at seven times the cost. Without the viscous term
    the exponent came out at 0.43 instead of 0.36, 20 of its standard errors off; with both again it is right.
    What was there before stays though chance drives it below zero, where it is held in the end: without it a
    coefficient that was 0.19 off had an error of 0.016 instead of 0.2.
    """
    law, joint = after.model.terms[-1].law, after.model.terms[-1].joint
    gone = [t for t in current.model.terms if t.joint == joint and t.effect in law.replaces]
    both = refit(after, (*after.model.terms, *gone))
    asked = [number_of(t, both.model.terms) for t in (*gone, after.model.terms[-1])]
    *beside, own = ((both.model.terms[k], both.std_errors[k]) for k in asked)
    possible = can_be(*own) and all(within_chance(*one) for one in beside)
    return both if possible and _cost(both, after) < _cost(after, after) else after


def _refit_without(
    current: Estimate, chosen: Score, dropped: tuple[str, ...], beyond: bool
) -> Estimate | None:
    """As :func:`refit_with`, without the terms of these names on the same joint."""
    term = with_start(chosen)
    weight = row_weight(current)

    def cost(one: Estimate) -> float:
        return float((chosen.candidate.view(one.fit.residual * weight) ** 2).sum())

    whole, part = cost(current), left_on(current, chosen.joint, weight)

    def stands(after: Estimate) -> bool:
        fall = 1.0 - cost(after) / whole
        own = 1.0 - left_on(after, chosen.joint, weight) / part
        held = fall > 0.0 and holds(after, term, own, beyond)
        if not held or unphysical_beside(current, after, term):
            return False
        within = 1.0 - cost(within_own_bounds(after, term)) / whole
        return within >= WITHIN_BOUNDS * fall

    kept = [t for t in current.model.terms if not (t.joint == term.joint and t.effect in dropped)]

    def fitted(begin: Term, rigid: np.ndarray | None = None) -> Estimate | None:
        try:
            after = refit(current, (*kept, begin), rigid)
        except Diverged:  # what was found to first order cannot be: a link runs away
            return None
        return after if stands(after) else None

    for start in starts(term, chosen.coefficients):
        after = fitted(start, chosen.candidate.start)
        if after is None:
            continue
        begin = from_inside(after.model.terms[number_of(term, after.model.terms)])
        again = None if begin is None else fitted(begin)
        less = again is not None and _cost(again, after) < _cost(after, after)
        return again if less else after
    return None


def left_on(found: Estimate, joint: int | slice, weight: np.ndarray | float = 1.0) -> float:
    """Squared error of a joint, or of several, by the weights of the rows (T, n), if any."""
    return float(np.square(found.fit.residual * weight)[:, joint].sum())


def share_left(current: Estimate, rest: Estimate) -> np.ndarray:
    """Shares (n,) of the squared errors without an addition that are left with it."""
    with_it, bare = (np.square(e.fit.residual).sum(axis=0) for e in (current, rest))
    return with_it / np.maximum(bare, 1e-300)


def refit(current: Estimate, terms: tuple[Term, ...], start: np.ndarray | None = None) -> Estimate:
    """Estimate with other terms, its sign widths found anew.

    It starts from the current rigid parameters where no others are given, and once more from the widths that
    are best of a few. Without a new law, whose values the widths of the current model may bend, that is done
    where these leave less than the fit: where they left more, 48 fits in a row came back to where they were.
    A new bristle that has run to the least way there is has become dry friction, and is no new law.
    Widths stay where the log hardly tells others: beside a bristle of joint 2 a motion that is never slow took
    1.7 mrad/s for the sharp sign of joint 1, of whose slow motion that left 0.15 N m instead of 0.013.
    """
    start = _rigid(current) if start is None else start
    after = fit_from(current, start, _on_their_clock(current, terms), current.model.width)
    width = best_widths(
        after.model.robot,
        after.model.terms,
        current.motions,
        current.rigids,
        _rigid(after),
        after.model.width,
    )
    near = np.abs(np.log(np.divide(width, after.model.width))).max() < _NEAR
    new = any(map(winds_up, lacking(after.model.terms, current.model.terms)))
    if near or not (new or _leaves_less(after, width)):
        return after
    again = fit_from(current, _rigid(after), after.model.terms, width)
    told = 1.0 - _TOLD / after.fit.effective_samples
    return again if _cost(again, after) < told * _cost(after, after) else after


def refit_once(current: Estimate, terms: tuple[Term, ...]) -> Estimate:
    """:func:`refit`, made once for all who ask what a model is without an addition.

    Of 42 fits of a slide ten had been made before. Those of a long log are too large to be held.
    """
    if not all(map(is_kept, current.motions)):
        return refit(current, terms)
    place = valued(terms)
    if place not in current.refits:
        current.refits[place] = refit(current, terms)
    return current.refits[place]


def _leaves_less(found: Estimate, width: tuple[float, ...]) -> bool:
    """Whether a model leaves less with signs of other widths, where all else that bends its columns stays."""
    model = found.model
    problem = Problem(model.robot, found.motions, found.rigids, bounded=False)
    there = settle(problem, Place(model.terms, width), _rigid(found))
    return weighted_cost(there.residual, found.fit.sigma) < _cost(found, found)


def _on_their_clock(current: Estimate, terms: tuple[Term, ...]) -> tuple[Term, ...]:
    """The terms, the times of those that happened where a log's torques show them.

    They were found by the clock of the current model. A delay of 30 ms that came to a push of 0.4 s would put
    it that much behind the torque that it explains.
    """
    earlier = clock_lag(terms) - clock_lag(current.model.terms)
    if not earlier:
        return terms
    happened = [t for t in current.model.terms if t.law.recurring]

    def moved(term: Term) -> Term:
        times = {n: term.values[n] - earlier for n in ("start", "end")}
        return replace(term, values={**term.values, **times})

    return tuple(moved(t) if t in happened else t for t in terms)


def refit_in_place(found: Estimate, term: Term) -> Estimate:
    """The estimate with a term in place of those it contains, whatever it comes to."""
    terms = found.model.terms
    kept = [t for t in terms if not (t.joint == term.joint and t.effect in term.law.contains)]
    return refit(found, (*kept, term))


def _rigid(one: Estimate) -> np.ndarray:
    """Rigid parameters, (10 n,)."""
    return np.asarray(one.model.robot.parameters).ravel()


def fit_from(
    current: Estimate,
    start: np.ndarray,
    terms: tuple[Term, ...],
    width: tuple[float, ...],
    refine_width: bool = True,
) -> Estimate:
    """Fit terms to the current logs from rigid parameters (10 n,) and widths, which are fitted too or stay.

    A shape that is not the usual one may have made up for a law that is new: beside that it is asked anew.
    """
    known = current.model.terms
    return estimate(
        current.model.robot,
        terms,
        current.motions,
        width=width,
        refine_width=refine_width,
        bounded=False,
        rigids=current.rigids,
        start=start,
        near=() if lacking(terms, known) else known,
    )


def _cost(one: Estimate, weights: Estimate) -> float:
    return weighted_cost(one.fit.residual, weights.fit.sigma)
