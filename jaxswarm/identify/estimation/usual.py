"""Shapes that a log hardly tells stay at what they usually are: their doubt would be others' doubt, too."""

from dataclasses import replace

import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.free_parameters import FreeParameter, free_parameters
from jaxswarm.identify.estimation.gauss_newton import Settled, apart_from
from jaxswarm.identify.estimation.problem import Problem

# A shape is told from its usual one beyond so many standard errors. On a log whose exponent of Stribeck's curve
# came to 1.3 with an error of 0.6, the height of the curve was 0.27 with one of 0.18 N m; at the usual
# exponent, which was the true one, it is told to 5 %.
_TOLD_APART = 2.0


def usual_shapes(terms: tuple[Term, ...]) -> frozenset[tuple[int | None, str]]:
    """The shapes that laws usually have the same, by the number of their term and their name."""
    return frozenset(
        (k, p.name) for k, t in enumerate(terms) for p in t.law.free(t.values) if p.usual
    )


def as_usual(terms: tuple[Term, ...]) -> tuple[Term, ...]:
    """The terms with those shapes at their usual values."""
    return tuple(
        replace(
            t, values={**t.values, **{p.name: p.nominal for p in t.law.free(t.values) if p.usual}}
        )
        for t in terms
    )


def told_apart(
    problem: Problem, here: Settled, doubted: list[FreeParameter]
) -> frozenset[tuple[int | None, str]]:
    """Those of the usual shapes that the log tells to be others, to first order.

    Args:
        problem: With the shapes held.
        here: The fit with them.
        doubted: What else moves, and what is held but not known.
    """
    if not problem.usual:
        return frozenset()
    every = free_parameters(here.place.terms)
    asked = [one for one in every if (one.term, one.name) in problem.usual]
    step, error = apart_from(problem, [*asked, *doubted], here)
    told = np.abs(step) > _TOLD_APART * error
    return frozenset((one.term, one.name) for one, far in zip(asked, told, strict=False) if far)
