"""Sums of two programs found together: what neither of them shows alone.

A term is chosen before the next one is known, and of two laws the best single program is often neither: of
q dq^5 ddq + q^2 dq^5 abs(load0) the terms were the 184th and the 76th alone, beside the best ones they were not
looked for any more, and what was found instead left twice the error. What a pair of columns takes off a
residual is known from three products of columns freed of the model, so that all pairs are looked at at once.
On four drawn laws whose sums had been missed the true pair was among the best three of millions.
"""

from collections.abc import Sequence

import numpy as np

from jaxswarm.decomposition import thin_svd
from jaxswarm.diagnose.discovery.front import Point, point
from jaxswarm.diagnose.discovery.on_host import columns_at
from jaxswarm.diagnose.discovery.pieces import Piece
from jaxswarm.diagnose.discovery.problem import OWN, Joint, SearchRows
from jaxswarm.diagnose.discovery.screening import Trial, surveyed, values_at
from jaxswarm.diagnose.discovery.sums import joined, polished, without_idle
from jaxswarm.diagnose.discovery.term_more import believed

# Columns of which all pairs are looked at, those that take most off alone: three seconds of a core.
_COLUMNS, _BLOCK = 12_000, 512
# Points of the constants beside the best alone, by their number: beside another term another one is best.
_MORE = {0: 0, 1: 4, 2: 3, 3: 0}
# Columns alike to this degree are one term, whose difference fits noise.
_ALIKE = 0.98
# Pairs of which all constants are refined.
_REFINED = 30


def pairs(problem: Joint, pieces: Sequence[Piece], folds: Sequence) -> tuple[list[Point], int]:
    """The best sums of two programs, all constants refined, and how many pairs were looked at.

    Args:
        problem: The joint.
        pieces: Programs of the grammar.
        folds: The regions, see :func:`region_folds`.
    """
    whole = problem.lin.crossfit.whole
    rows = problem.rows_of(whole)
    trials, columns, along = _columns(problem, rows, pieces)
    done: dict[tuple[int, int], Point] = {}
    for one, two in best_partners(columns, along):
        a, b = trials[one][0], trials[two][0]
        own = (min(a, b), max(a, b))
        if own in done:
            continue
        formula = joined(joined(None, trials[one][1]), trials[two][1])
        formula = without_idle(problem, polished(problem, formula, whole))
        done[own] = point(problem, formula, folds)
        if len(done) == _REFINED:
            break
    found = [p for p in done.values() if np.isfinite(p.error) and believed(problem, p)]
    return found, len(pieces) * (len(pieces) - 1) // 2


def _columns(
    problem: Joint, rows: SearchRows, pieces: Sequence[Piece]
) -> tuple[list[tuple[int, Trial]], np.ndarray, np.ndarray]:
    """Programs at points of their constants, by their number, with what :func:`freed` tells of them."""
    lattices, best, _ = surveyed(problem, rows, pieces)
    span = _span(rows)
    trials, columns, shares = [], [], []
    for number, piece in enumerate(pieces):
        lattice = lattices[len(piece.constants)]
        more = _MORE[len(piece.constants)]
        others = np.linspace(0, len(lattice) - 1, more + 2)[1:-1].round().astype(int)
        points = np.concatenate([best[[number]], lattice[others]])
        free, along, own = freed(columns_at(problem.names, rows, piece, points), rows, span)
        trials += [
            (number, Trial(piece, values_at(piece, points[k]), float(along[k] ** 2)))
            for k in np.flatnonzero(own)
        ]
        columns.append(free[own])
        shares.append(along[own])
    along = np.concatenate(shares)
    first = np.argsort(-(along**2), kind="stable")[:_COLUMNS]
    return [trials[k] for k in first], np.concatenate(columns)[first], along[first]


def _span(rows: SearchRows) -> tuple[np.ndarray, np.ndarray]:
    """Directions (R, b) of the model's basis on the joint's rows, and what a column keeps of itself there.

    The basis is orthonormal over all joints: on the rows of one it holds a direction in part.
    """
    directions, sizes, _ = thin_svd(np.asarray(rows.basis))
    return directions, np.sqrt(np.maximum(1.0 - sizes**2, 0.0))


def freed(
    columns: np.ndarray, rows: SearchRows, span: tuple[np.ndarray, np.ndarray]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Columns (m, R) of unit size whose products are those of what the model lacks of them.

    Returns:
        These, how far each goes along the residual (m,), its share being the square, and which the model does
        not hold already.
    """
    directions, kept = span
    aim = np.asarray(rows.residual) / np.linalg.norm(rows.residual)
    with np.errstate(all="ignore"):
        size = np.einsum("mr,mr->m", columns, columns)
        free = columns - (columns @ directions * (1.0 - kept)) @ directions.T
        left = np.einsum("mr,mr->m", free, free)
        own = (left > OWN * size) & np.isfinite(size) & (size > 0.0)
        norm = np.sqrt(np.where(own, left, 1.0))
    return free / norm[:, None], columns @ aim / norm, own


def best_partners(columns: np.ndarray, along: np.ndarray) -> list[tuple[int, int]]:
    """Every column with the one beside which the two take most off the residual, the best first."""
    gains, partners = [], []
    for start in range(0, len(columns), _BLOCK):
        inner = columns[start : start + _BLOCK] @ columns.T
        own = along[start : start + _BLOCK, None]
        gain = own * own + along**2 - 2.0 * inner * own * along
        alike = np.abs(inner) >= _ALIKE
        gain = np.where(alike, 0.0, gain / np.where(alike, 1.0, 1.0 - inner * inner))
        best = gain.argmax(axis=1)
        partners.append(best)
        gains.append(gain[np.arange(len(best)), best])
    order = np.argsort(-np.concatenate(gains), kind="stable")
    partner = np.concatenate(partners)
    return [(int(k), int(partner[k])) for k in order]
