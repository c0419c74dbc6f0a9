"""A found law seen again, in the model that it led to: in its own shapes, the simplest that says as much.

The load, the widths of signs and the parameters of the arm that a formula is searched with are those of a
model that lacks it, and bend it: beside q^2 tanh(load/s) load0 a product with the acceleration seemed to be a
second term, which made good what the load was off by.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.discovery.front import Point, point, ranked, region_folds, strict
from jaxswarm.diagnose.discovery.grammar import programs, skeleton
from jaxswarm.diagnose.discovery.nearby import nearby
from jaxswarm.diagnose.discovery.problem import Joint
from jaxswarm.diagnose.discovery.sums import Sum, polished
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.refit import fit_from
from jaxswarm.effects.alike import without
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate

# Formulas whose constants are learned without the region on which they are scored.
_STRICT = 6


def bare_of(diagnosis: Diagnosis, after: Estimate, term: Term) -> Diagnosis:
    """The diagnosis without a law, but with the sign widths of the model that holds it."""
    start = np.asarray(after.model.robot.parameters).ravel()
    terms, width = without(term, after.model.terms), after.model.width
    rest = fit_from(after, start, terms, width, refine_width=False)
    return replace(diagnosis, final=rest, crossfit=cross_fit(rest))


def shapes_of(
    problem: Joint, formulas: Sequence[Sum], label: np.ndarray, seed: int
) -> tuple[list[Point], int]:
    """Formulas and those around them, the shortest description first, and how many programs were tried.

    Args:
        problem: The joint in the model that a formula led to, without it.
        formulas: That one, and others from which to begin.
        label: Region of every row.
        seed: Of the swarms.
    """
    whole = problem.lin.crossfit.whole
    folds = region_folds(whole, label)
    starts = [point(problem, polished(problem, one, whole), folds) for one in formulas]
    starts = [one for one in starts if np.isfinite(one.error)]
    pieces = programs(problem.data, problem.units, problem.angles)
    found, tried = nearby(problem, pieces, starts, folds, seed)
    log = problem.lin.found.regression.log
    first = ranked([*starts, *found], log)[:_STRICT]
    return ranked([strict(problem, one, folds) for one in first], log), tried


def alike_in_form(one: Sum, other: Sum) -> bool:
    """Whether two formulas have the same terms, in any order and with any constants."""
    forms = [sorted(skeleton(p) for p in formula.programs) for formula in (one, other)]
    return forms[0] == forms[1]
