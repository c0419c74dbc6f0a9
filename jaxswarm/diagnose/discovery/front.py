"""Which formula: error on other motion against the length of its description.

Every candidate is fitted with one region of the joint's states left out at a time and scored there; what it
has learned elsewhere of a wrong form it gets wrong. The front holds those that no shorter one beats. Of these
the one is chosen whose description in bits, of itself and of what it leaves, is shortest (J. Rissanen,
Automatica 14 (1978)); a form that physics knows costs less than one that it does not.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from jaxswarm.diagnose.discovery.problem import Joint
from jaxswarm.diagnose.discovery.sums import Sum, polished, said
from jaxswarm.diagnose.discovery.symmetry import Symmetry, symmetry_of
from jaxswarm.diagnose.folds.partial_out import Fold
from jaxswarm.effects.postfix import WORDS, fields_of
from jaxswarm.identify.estimation.covariance import correlation_length

# Bits of a token, and of a form without a symmetry that physics knows: what two tokens cost.
_TOKEN = float(np.log2(len(WORDS)))
_ODD_FORM = 2.0 * _TOKEN
# Steps by which the constants of a formula are learned anew without a region.
_STEPS = 10
# The fewest independent samples by which constants are priced.
_LEAST_SAMPLES = 20.0


class Point(NamedTuple):
    """A formula with what it costs and what it leaves.

    Attributes:
        formula: The terms with values.
        error: Share of the joint's squared error left on regions that were not fitted; of those that are put to
            the proof with all constants, see :func:`strict`.
        bits: Length of its description.
        left: Residual of every row, where its region was not fitted, weighted, (T,).
        symmetry: What its form says of energy and direction.
        length: Bits of itself and of what it leaves, among the candidates it was ranked with.
    """

    formula: Sum
    error: float
    bits: float
    left: np.ndarray
    symmetry: Symmetry
    length: float = np.inf


def region_folds(whole: Fold, label: np.ndarray) -> list[tuple[Fold, np.ndarray]]:
    """The model fitted without one region at a time, and the rows of that region."""
    return [(whole.trained_on(label != k), label == k) for k in np.unique(label)]


def point(problem: Joint, formula: Sum, folds: Sequence[tuple[Fold, np.ndarray]]) -> Point:
    """Score one formula."""
    left = np.zeros(len(problem.rows))
    before = 0.0
    for fold, rows in folds:
        own = fold.residual[rows, problem.joint]
        left[rows] = own - said(problem, formula, fold)[rows]
        before += float(own @ own)
    error = float(left @ left) / max(before, 1e-300)
    symmetry = symmetry_of(problem, formula)
    bits = _TOKEN * sum(one.tokens for one in formula.pieces)
    bits += 0.0 if symmetry.known else _ODD_FORM
    # Nothing goes by the time since a log began where it may as well go by what was measured.
    timed = any("t" in fields_of(p) for p in formula.programs)
    bits += _ODD_FORM if timed and "temperature" in problem.data else 0.0
    return Point(formula, error, bits, left, symmetry)


def strict(problem: Joint, one: Point, folds: Sequence[tuple[Fold, np.ndarray]]) -> Point:
    """The same formula with its constants learned without the region on which it is scored.

    A bump that was laid where the residual is large says nothing of a region that was not seen.
    """
    if not one.formula.constants:
        return one
    left, before = np.zeros(len(problem.rows)), 0.0
    for fold, rows in folds:
        own = fold.residual[rows, problem.joint]
        learned = polished(problem, one.formula, fold, _STEPS)
        left[rows] = own - said(problem, learned, fold)[rows]
        before += float(own @ own)
    return one._replace(error=float(left @ left) / max(before, 1e-300), left=left)


def front(points: Sequence[Point]) -> list[Point]:
    """Those that no shorter one beats, the shortest first."""
    kept: list[Point] = []
    for one in sorted(points, key=lambda x: (x.bits, x.error)):
        if not kept or one.error < kept[-1].error:
            kept.append(one)
    return kept


def ranked(points: Sequence[Point], log: np.ndarray) -> list[Point]:
    """All candidates by the length of the whole description, the shortest first."""
    best = min(points, key=lambda x: x.error)
    memory = correlation_length(best.left[:, None], log)
    samples = max(len(best.left) / memory, _LEAST_SAMPLES)

    def length(one: Point) -> float:
        constants = len(one.formula.constants) + len(one.formula.pieces)
        own = one.bits + 0.5 * constants * np.log2(samples)
        return own + 0.5 * samples * np.log2(max(one.error, 1e-12))

    return sorted((one._replace(length=length(one)) for one in points), key=lambda x: x.length)


def alike(one: Point, other: Point) -> float:
    """How much less error the better of two leaves, in standard errors over blocks of rows."""
    change = one.left**2 - other.left**2
    parts = np.array([part.sum() for part in np.array_split(change, _PARTS)])
    spread = parts.std(ddof=1) * np.sqrt(_PARTS)
    return float(parts.sum() / max(spread, 1e-300))


# Stretches of time over which two errors are compared.
_PARTS = 20
