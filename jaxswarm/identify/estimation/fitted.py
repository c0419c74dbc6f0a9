"""The fit from a place: with its widths or others, and with shapes that the log tells from the usual ones."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.choose_widths import choose_widths
from jaxswarm.identify.estimation.free_parameters import FreeParameter, Place
from jaxswarm.identify.estimation.gauss_newton import Settled, newton, settle
from jaxswarm.identify.estimation.problem import Problem
from jaxswarm.identify.estimation.sign_width import alike, driven_by_friction, sharing
from jaxswarm.identify.estimation.usual import as_usual, told_apart, told_before, usual_shapes
from jaxswarm.identify.estimation.widths_alone import free_widths

# Where a fit ended, what is free there, and widths that are held but not known.
Fitted = tuple[Settled, list[FreeParameter], list[FreeParameter]]


def with_shapes(
    problem: Problem,
    terms: tuple[Term, ...],
    near: Sequence[Term],
    width: tuple[float, ...],
    pi: np.ndarray,
    fit: Callable[[Problem, Place, np.ndarray], Fitted],
) -> tuple[Problem, Fitted]:
    """The fit in which shapes are held at what they usually are, but for those that the log tells to be others.

    What a fit near this one told is asked first whether it is usual after all; where it is, all are asked anew.

    Args:
        problem: Without shapes that are held.
        terms: Laws, from whose values the fit starts.
        near: Terms of a fit near this one.
        width, pi: Widths and rigid parameters (10 n,) to start from.
        fit: Fits from a place.

    Returns:
        The problem with the shapes that are held, and the fit.
    """
    before = told_before(terms, near)
    for known in (before, frozenset()):
        held = replace(problem, usual=usual_shapes(terms) - known)
        found = fit(held, Place(as_usual(terms, known), width), pi)
        here, moving, held_widths = found
        told = told_apart(held, here, [*moving, *held_widths])
        if told >= known:
            break
    if told - known:
        held = replace(held, usual=held.usual - told)
        # Widths that were told beside a wrong shape made up for it, and would hold it there.
        found = fit(held, here.place._replace(width=width), here.pi)
    return held, found


def fitted(
    groups: Sequence[tuple[int, ...]], problem: Problem, place: Place, pi: np.ndarray
) -> Fitted:
    """The fit from a place, what is free there, and widths that are held but not known."""

    def from_here(groups):
        widths = free_widths(problem.motions, alike(groups, place.width), place.width)
        moving = problem.free(place.terms, widths)
        # Nobody but the search holds where it starts: the columns of a long log are as large as all else.
        return newton(problem, moving, settle(problem, place, pi)), moving

    here, moving = from_here(groups)
    driven = driven_by_friction(problem.robot, here.place.terms, here.theta)
    if driven:  # their signs keep the width of their kind
        groups = [g for g in (tuple(j for j in g if j not in driven) for g in groups) if g]
        if any(one.joints and driven.issuperset(one.joints) for one in moving):
            here, moving = from_here(groups)
    return choose_widths(problem, here, moving, groups)


def fitted_at_width(
    groups: Sequence[tuple[int, ...]], problem: Problem, place: Place, pi: np.ndarray
) -> Fitted:
    """The fit with the widths of a place, what is free there, and the groups' widths, which are not known."""
    here, moving, _ = fitted([], problem, place, pi)
    return here, moving, free_widths(problem.motions, sharing(groups, place.width), place.width)
