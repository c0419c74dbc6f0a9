"""Shapes that a log hardly tells stay at what they usually are: their doubt would be others' doubt, too."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.effects.alike import has, number_of
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.free_covariance import apart_from
from jaxswarm.identify.estimation.free_parameters import FreeParameter, free_parameters, read
from jaxswarm.identify.estimation.gauss_newton import Settled
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


def told_before(terms: tuple[Term, ...], near: Sequence[Term]) -> frozenset[tuple[int | None, str]]:
    """Those of the usual shapes of some terms that a fit near them, by its terms, told to be others.

    >>> lag = Term("torque_lag", values={"tc": 0.02, "seconds": 0.005})
    >>> told_before((Term("viscous_friction", 0), lag), (lag,))
    frozenset({(1, 'seconds')})
    >>> told_before((lag,), (Term("torque_lag", values={"tc": 0.02, "seconds": 0.0}),))
    frozenset()
    """
    return frozenset(
        (k, p.name)
        for k, t in enumerate(terms)
        for p in t.law.free(t.values)
        if p.usual and has(t, near)
        if near[number_of(t, near)].values.get(p.name, p.nominal) != p.nominal
    )


def as_usual(
    terms: tuple[Term, ...], told: frozenset[tuple[int | None, str]] = frozenset()
) -> tuple[Term, ...]:
    """The terms with those shapes at their usual values that were not ``told`` to be others."""

    def usual(k: int, term: Term) -> dict[str, float]:
        shapes = (p for p in term.law.free(term.values) if p.usual)
        return {p.name: p.nominal for p in shapes if (k, p.name) not in told}

    return tuple(replace(t, values=t.values | usual(k, t)) for k, t in enumerate(terms))


def told_apart(
    problem: Problem, here: Settled, doubted: list[FreeParameter]
) -> frozenset[tuple[int | None, str]]:
    """Those of the usual shapes that the log tells to be others, to first order.

    Args:
        problem: With all or some of the shapes held.
        here: The fit with them.
        doubted: What moves, and what is held but not known.
    """
    asked = [one for one in free_parameters(here.place.terms) if one.parameter.usual]
    if not asked:
        return frozenset()
    others = [one for one in doubted if not one.parameter.usual]
    step, error = apart_from(problem, [*asked, *others], here)
    usual = np.array([one.parameter.encode(one.parameter.nominal) for one in asked])
    far = np.abs(read(here.place, asked) + step[: len(asked)] - usual)
    told = far > _TOLD_APART * error[: len(asked)]
    return frozenset(
        (one.term, one.name) for one, is_told in zip(asked, told, strict=True) if is_told
    )
