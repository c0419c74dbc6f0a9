"""Formulas that fit like the chosen one: which they are, and the model with each in its place."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.decision.rules import FORMULA_NEAR, FORMULA_TIE
from jaxswarm.diagnose.discovery.as_term import as_term
from jaxswarm.diagnose.discovery.front import Point, alike
from jaxswarm.diagnose.discovery.grammar import skeleton
from jaxswarm.diagnose.discovery.problem import Joint
from jaxswarm.diagnose.discovery.stand_ins import Discovery, Rival
from jaxswarm.diagnose.folds.noise import noise_of
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.effects.alike import without
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.finite_columns import Diverged

# Formulas that are told beside the chosen one.
_TOLD = 3


def fit_alike(
    problem: Joint, one: Point, points: Sequence[Point]
) -> tuple[tuple[Point, Term], ...]:
    """Formulas of another form that fit alike, the shortest first."""
    told = near_ones(one, points)[:_TOLD]
    return tuple((point, as_term(problem, point.formula)) for point in told)


def near_ones(one: Point, points: Sequence[Point]) -> list[Point]:
    """Points of another form than one whose errors are not told from its own: of each form the first."""
    told: dict[tuple, Point] = {}
    for point in points:
        near = abs(alike(point, one)) < FORMULA_TIE or point.error < FORMULA_NEAR * one.error
        if near and not _extends(point, one):
            told.setdefault(tuple(sorted(skeleton(p) for p in point.formula.programs)), point)
    return list(told.values())


def _extends(point: Point, one: Point) -> bool:
    """Whether a formula is the other one, or the other one with further factors or terms."""
    terms = [skeleton(p) for p in point.formula.programs]
    return all(
        any(all(own.count(f) >= inner.count(f) for f in inner) for own in terms)
        for inner in (skeleton(p) for p in one.formula.programs)
    )


def fitted_rivals(one: Discovery) -> tuple[Rival, ...]:
    """The model with each formula that fits alike in place of the found law; without those that run away."""
    found, kept = [], without(one.added, one.after.model.terms)
    for point, term in one.alternatives:
        try:
            fitted = refit(one.after, (*kept, term))
        except Diverged:
            continue
        apart = fitted.fit.residual[:, term.joint] - one.after.fit.residual[:, term.joint]
        rms = float(np.sqrt(np.mean(apart**2)))
        over_noise = rms / float(noise_of(one.after)[term.joint])
        found.append(Rival(point, term, fitted.model, rms, over_noise))
    return tuple(found)
