"""Formulas around those that were found: each term in all other shapes of its own variables.

Those are a hundredth of all programs, so that it goes on while the error falls at all. Two terms bend each
other by a few hundredths: beside dq abs(q_o) dq_o^2 in place of dq/((dq/s)^2 + 2) abs(q_o) dq_o^2 the true
other term was not the best one, and setting the first right alone took a fifteenth off the error.
"""

from collections.abc import Sequence

from jaxswarm.diagnose.discovery.front import Point
from jaxswarm.diagnose.discovery.pieces import Piece
from jaxswarm.diagnose.discovery.problem import Joint
from jaxswarm.diagnose.discovery.sums import without_term
from jaxswarm.diagnose.discovery.term_more import believed, explained, one_more
from jaxswarm.effects.postfix import fields_of

# Terms of a sum around which is looked, rounds over all of them, the share of the squared error that a round
# has to take off, and shapes of a term that are refined beside the others.
_TERMS, _ROUNDS, _SLIGHT, _TRIED = 2, 4, 0.02, 10
_SAME = {"direction": "dq", "static_load": "load"}


def nearby(
    problem: Joint, pieces: Sequence[Piece], points: Sequence[Point], folds, seed: int
) -> tuple[list[Point], int]:
    """The formulas around the best of some points, and how many programs were tried.

    Args:
        problem: The joint.
        pieces: Programs of the grammar.
        points: Where to begin, the best first.
        folds: The regions, see :func:`region_folds`.
        seed: Of the swarms.
    """
    done: list[Point] = []
    tried = 0
    for best in _starts(points):
        for _ in range(_ROUNDS):
            found: list[Point] = []
            for k, piece in enumerate(best.formula.pieces):
                own = [one for one in pieces if _variables(one) == _variables(piece)]
                rest = without_term(best.formula, k) if len(best.formula.pieces) > 1 else None
                found += one_more(problem, own, rest, folds, seed, _TRIED, wild=True)
                tried += len(own)
            done += found
            better = min(found, key=lambda p: p.error, default=best)
            if better.error > (1.0 - _SLIGHT) * best.error:
                break
            best = better
            if explained(problem, best):
                break
    return [one for one in done if believed(problem, one)], tried


def _starts(points: Sequence[Point]) -> list[Point]:
    """The best of the points with every number of terms: what is added to a bent term bends the next ones."""
    best: dict[int, Point] = {}
    for one in points:
        best.setdefault(len(one.formula.pieces), one)
    return [best[terms] for terms in range(_TERMS, 0, -1) if terms in best]


def _variables(piece: Piece) -> frozenset[str]:
    """What a program is a function of: the direction is that of the velocity, the static load is a load."""
    return frozenset(_SAME.get(name, name) for name in fields_of(piece.program))
