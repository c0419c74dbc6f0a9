r"""A cable or spring from a link to a fixed point, over two joints: what no product of pieces comes near.

The links of a joint and of the next one lie in a plane, the first of unit length; the cable ends at ``e`` on
the second and at the point ``(c, d)`` of the base. It is as long as

.. math:: L^2 = (\cos q + e \cos w - c)^2 + (\sin q + e \sin w - d)^2, \quad w = q + q_o \text{ or } q - q_o,

and pulls by :math:`L - 2/g` beyond its free length :math:`2/g`. Four constants are too many for the survey of
all programs: each form is looked at at many points of them, and refined from the best.
"""

from collections.abc import Container, Iterator, Sequence

import numpy as np
import scipy

from jaxswarm.diagnose.discovery.front import Point, point
from jaxswarm.diagnose.discovery.on_host import shares_at
from jaxswarm.diagnose.discovery.pieces import Piece
from jaxswarm.diagnose.discovery.problem import Joint
from jaxswarm.diagnose.discovery.reach import tame
from jaxswarm.diagnose.discovery.sums import Sum, polished
from jaxswarm.diagnose.folds.partial_out import Fold
from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.postfix import Program

# Points of the constants at which a form is looked at, as a power of two, and the best of it that are refined.
_LOOKS, _REFINED = 9, 2
# In lengths of the first link: where a cable may end, and how long it may be.
_CONSTANTS = (
    Parameter("e", "1", 0.2, 2.0, False, 0.7, "from the second joint to the cable", "log"),
    Parameter(
        "c", "1", -2.0, 2.0, False, 0.0, "fixed point, along the zero of the joint", "linear"
    ),
    Parameter("d", "1", -2.0, 2.0, False, 0.0, "fixed point, across it", "linear"),
    Parameter("g", "1", 0.65, 20.0, False, 2.0, "two over the free length", "log"),
)


def forms(fields: Container[str]) -> Iterator[Piece]:
    """Torque of such a cable on the first of two joints, then on the second, for both ways the second turns."""
    if not ("q" in fields and "q_other" in fields):
        return
    for sign in ("+", "-"):
        yield Piece(_on_first("q", ("q", "q_other", sign)), _CONSTANTS, named=True)
        # The partner is the first joint then; the joint itself turns the link with the same sign.
        yield Piece(_on_second("q_other", "q", sign), _CONSTANTS, named=True)


def cables(problem: Joint, folds: Sequence[tuple[Fold, np.ndarray]]) -> tuple[list[Point], int]:
    """The best cables with their errors on other motion, and how many forms were tried."""
    pieces = list(forms(problem.data)) if problem.angles else []
    whole = problem.lin.crossfit.whole
    rows = problem.rows_of(whole)
    looks = scipy.stats.qmc.Sobol(len(_CONSTANTS), scramble=False).random_base2(_LOOKS)
    points = []
    for piece in pieces:
        shares = shares_at(problem.names, rows, piece, looks.astype(np.float32))
        for place in looks[np.argsort(-shares)[:_REFINED]]:
            values = {p.name: float(p.decode(u)) for p, u in zip(_CONSTANTS, place, strict=True)}
            formula = polished(problem, Sum((piece,), values), whole)
            if tame(problem, formula):
                points.append(point(problem, formula, folds))
    return [one for one in points if np.isfinite(one.error)], len(pieces)


def _on_first(q: str, turned: Program) -> Program:
    """The fixed point across the first link and what it carries, times the pull."""
    across = ("c", *_end(q, turned, "sin"), "*", "d", *_end(q, turned, "cos"), "*", "-")
    return (*_pull(q, turned), *across, "*")


def _on_second(first: str, q: str, sign: str) -> Program:
    """The fixed point and the first link across the second one, times the pull."""
    turned = (first, q, sign)
    across = ("c", *turned, "sin", "*", "d", *turned, "cos", "*", "-")
    # sin(q - w), which is the second joint's own sine.
    between = (q, "sin", "-" if sign == "+" else "+")
    return (*_pull(first, turned), *across, *between, "*")


def _end(q: str, turned: Program, of: str) -> Program:
    """A coordinate of the cable's end on the second link."""
    return (q, of, *turned, of, "e", "*", "+")


def _pull(q: str, turned: Program) -> Program:
    """What a cable pulls by over its length: g - 2/L beyond its free length 2/g."""
    square = (*_end(q, turned, "cos"), "c", "-", "square")
    square = (*square, *_end(q, turned, "sin"), "d", "-", "square", "+")
    return ("g", "2", *square, "root", "/", "-", "pos")
