"""All formulas that come into question for a joint: single programs, and sums of up to three."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.decision.rules import MOST_LEFT
from jaxswarm.diagnose.discovery.cables import cables
from jaxswarm.diagnose.discovery.devices import families
from jaxswarm.diagnose.discovery.front import (
    Point,
    front,
    point,
    ranked,
    region_folds,
    strict,
)
from jaxswarm.diagnose.discovery.moving_load import goes_by_load
from jaxswarm.diagnose.discovery.nearby import nearby
from jaxswarm.diagnose.discovery.pairs import pairs
from jaxswarm.diagnose.discovery.pieces import Piece, numbered
from jaxswarm.diagnose.discovery.problem import Joint
from jaxswarm.diagnose.discovery.reach import tame
from jaxswarm.diagnose.discovery.sums import Sum, seen_beside, without_term
from jaxswarm.diagnose.discovery.term_more import explained, one_more

# Terms of a sum at most, sums that get one more, and formulas beside those of the front whose constants are
# learned without the region on which they are scored.
MOST_TERMS, _LEADS, _STRICT = 3, 2, 10
# A term more is looked for while the joint is not near its noise, and while the last one took this share of the
# squared error that was left before it.
_WORTH = 0.1
# Looks through all programs of one size, each by the load that the last one led to, at most.
_SEEN = 3
# How often the terms of a sum are searched anew, one beside the others.
_EXCHANGES = 2


def candidates(
    problem: Joint,
    pieces: Sequence[Piece],
    label: np.ndarray,
    seed: int = 0,
    terms: int = MOST_TERMS,
) -> tuple[Joint, list[Point], int]:
    """The best formulas with their errors on other motion, the best first, and how many programs were tried.

    Before them the joint as it was seen in the end, with the loads of the model beside the best formula.

    Args:
        problem: The joint.
        pieces: Programs of the grammar.
        label: Region of every row.
        seed: Of the swarms.
        terms: Terms of a sum at most.
    """
    crossfit = problem.lin.crossfit
    log = problem.lin.found.regression.log
    folds = region_folds(crossfit.whole, label)
    points: list[Point] = []
    tried = 0
    leads: Sequence[Sum] = []
    for size in range(1, terms + 1):
        found, count, problem = _of_size(problem, pieces, leads, folds, seed)
        tried += count
        if not found:
            break
        best = min((p.error for p in points), default=1.0)
        points = ranked([*points, *found], log)
        least = min(p.error for p in found)
        if explained(problem, points[0]) or least > (1.0 - _WORTH) * best:
            break
        found, count = _exchanged(problem, pieces, points[0], folds, seed)
        tried += count
        if found:
            points = ranked([*points, *found], log)
            if explained(problem, points[0]):
                break
        new = {id(p.formula) for p in points if len(p.formula.pieces) == size}
        leads = [p.formula for p in points if id(p.formula) in new][:_LEADS]
    if points and terms > 1 and not explained(problem, points[0]):
        found, count = nearby(problem, pieces, points, folds, seed)
        points, tried = ranked([*points, *found], log), tried + count
    kept = {id(p): p for p in [*points[:_STRICT], *front(points)]}
    told = [strict(problem, p, folds) for p in kept.values()]
    return problem, ranked(told, log) if told else [], tried


def _of_size(
    problem: Joint, pieces: Sequence[Piece], leads: Sequence[Sum], folds, seed: int
) -> tuple[list[Point], int, Joint]:
    """Sums with a term more than the leads have, how many programs were tried, and the joint as seen then.

    Programs are looked through by the load of a model that lacks the law, and then by that of the model with
    the best formula, whatever that goes by, as long as that pays: of exp(k q) dq ddq + q^3 abs(dq load) neither
    term was among the best at first, since the load was off by half its size.
    """
    found: list[Point] = []
    tried, least = 0, np.inf
    asked, before = pieces, problem
    for look in range(_SEEN):
        if not look and not leads:
            strung, count = cables(problem, folds)
            found, tried = [*_families(problem, folds), *strung], count
        if asked is pieces and leads and len(leads[0].pieces) == 1:
            both, count = pairs(problem, pieces, folds)
            found, tried = found + both, tried + count
        for lead in leads or (None,):
            found += one_more(problem, asked, lead, folds, seed)
            tried += len(asked)
        best = min(found, key=lambda p: p.error, default=None)
        by_load = best is not None and goes_by_load(problem, best.formula.programs)
        if best is None or best.error > (1.0 - _WORTH) * least:
            problem = problem if by_load else before
            break
        # A form that tells little of the law may bend the load further.
        if explained(problem, best) or not (by_load or best.error < MOST_LEFT):
            break
        beside = seen_beside(problem, best.formula)
        if beside is None:
            break
        before, problem, least = problem, beside, best.error
        if not by_load:  # beside it nothing else is seen otherwise
            asked = [one for one in pieces if goes_by_load(problem, [one.program])]
    return found, tried, problem


def _exchanged(
    problem: Joint, pieces: Sequence[Piece], best: Point, folds, seed: int
) -> tuple[list[Point], int]:
    """Sums in which one term of the best was searched anew beside the others, and how many programs were tried.

    A term is chosen before the next one is known, and leans to what that one says: of cos(q) exp(-(dq/s)^2)
    beside a hinge the first choice was exp(-(dq/s)^2) load, and only beside the hinge the right one was better.
    """
    done: list[Point] = []
    tried = 0
    for _ in range(_EXCHANGES):
        # One term has nothing beside it; more than are added one by one were found together.
        if not 2 <= len(best.formula.pieces) <= MOST_TERMS or explained(problem, best):
            break
        found: list[Point] = []
        for k in range(len(best.formula.pieces)):
            found += one_more(problem, pieces, without_term(best.formula, k), folds, seed)
            tried += len(pieces)
        done += found
        better = min(found, key=lambda p: p.error, default=best)
        if better.error > (1.0 - _WORTH) * best.error:
            break
        best = better
    return done, tried


def _families(problem: Joint, folds) -> list[Point]:
    """Sums whose terms are found together only."""
    sums = [Sum(numbered(own), {}) for own in families(problem.data, problem.angles)]
    points = [point(problem, one, folds) for one in sums if tame(problem, one)]
    return [one for one in points if np.isfinite(one.error)]
