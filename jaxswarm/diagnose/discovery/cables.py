r"""A cable or spring from a link to a fixed point, over two joints: what no product of pieces comes near.

The links of a joint and of the next one lie in a plane, the first of unit length; the cable ends at ``e`` on
the second and at the point ``(c, d)`` of the base. It is as long as

.. math:: L^2 = (\cos q + e \cos w - c)^2 + (\sin q + e \sin w - d)^2, \quad w = q + q_o \text{ or } q - q_o,

and pulls by :math:`L - 2/g` beyond its free length :math:`2/g`. Four constants are too many for the survey of
all programs: each form is looked at at many points of them, and refined from the best.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy

from jaxswarm.diagnose.discovery.front import Point, point
from jaxswarm.diagnose.discovery.pieces import Piece
from jaxswarm.diagnose.discovery.problem import Joint
from jaxswarm.diagnose.discovery.reach import tame
from jaxswarm.diagnose.discovery.sums import Sum
from jaxswarm.diagnose.folds.partial_out import Fold
from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.postfix import Program, evaluate

# Points of the constants at which a form is looked at, as a power of two, the best of it that are refined, and
# the steps of that.
_LOOKS, _REFINED, _STEPS = 9, 3, 40
# In lengths of the first link: where a cable may end, and how long it may be.
_CONSTANTS = (
    Parameter("e", "1", 0.2, 2.0, False, 0.7, "from the second joint to the cable", "log"),
    Parameter(
        "c", "1", -2.0, 2.0, False, 0.0, "fixed point, along the zero of the joint", "linear"
    ),
    Parameter("d", "1", -2.0, 2.0, False, 0.0, "fixed point, across it", "linear"),
    Parameter("g", "1", 0.65, 20.0, False, 2.0, "two over the free length", "log"),
)


class Form(NamedTuple):
    """Torques of such a cable on a joint and on its partner.

    Attributes:
        own: On the joint.
        partners: On its partner.
        first: Whether the joint carries the other one.
        way: Which way the second joint turns the link, +1 or -1.
    """

    own: Program
    partners: Program
    first: bool
    way: int

    def sizes(self, e: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What the two programs are multiplied by to be slopes of one energy."""
        second = self.way * e
        return (np.ones_like(e), second) if self.first else (second, np.ones_like(e))


def forms() -> list[Form]:
    """A joint that carries its partner, or is carried by it, for both ways the second one turns."""
    told = []
    for way, sign in ((1, "+"), (-1, "-")):
        for first, second in (("q", "q_other"), ("q_other", "q")):
            turned = (first, second, sign)
            both = _on_first(first, turned), _on_second(first, second, sign)
            own, partners = both if first == "q" else both[::-1]
            told.append(Form(own, partners, first == "q", way))
    return told


def cables(problem: Joint, folds: Sequence[tuple[Fold, np.ndarray]]) -> tuple[list[Point], int]:
    """The best cable with its error on other motion, and how many forms were tried."""
    if not ({"q", "q_other"} <= set(problem.data) and problem.angles):
        return [], 0
    seen = _Seen(problem)
    looks = scipy.stats.qmc.Sobol(len(_CONSTANTS), scramble=False).random_base2(_LOOKS)
    starts = []
    for form in forms():
        shares = seen.shares(form, looks)
        starts += [(shares[k], form, looks[k]) for k in np.argsort(-shares)[:_REFINED]]
    refined = [(*seen.refined(form, place), form) for _, form, place in starts]
    best, place, form = min(refined, key=lambda one: one[0])
    if not np.isfinite(best):
        return [], len(starts)
    values = {p.name: float(p.decode(u)) for p, u in zip(_CONSTANTS, place, strict=True)}
    formula = Sum((Piece(form.own, _CONSTANTS, named=True),), values)
    if not tame(problem, formula):
        return [], len(starts)
    found = point(problem, formula, folds)
    return [found] if np.isfinite(found.error) else [], len(starts)


class _Seen:
    """What is seen of a cable: on the joint, and on its partner where that lacks something as well.

    One energy gives the torques on both. A joint alone hardly tells which of the two it is: of a cable from the
    second link both roles left the same on it.
    """

    def __init__(self, problem: Joint):
        crossfit = problem.both or problem.lin.crossfit
        own = crossfit.whole.trained_on(problem.rows)
        assert problem.other is not None
        self.joints = [problem.joint] + ([problem.other] if problem.both else [])
        self.data = {n: problem.data[n][problem.rows] for n in ("q", "q_other")}
        self.weight = crossfit.weight[problem.rows][:, self.joints].T
        self.basis = (
            own.basis[problem.rows][:, self.joints].transpose(1, 0, 2).reshape(self.weight.size, -1)
        )
        self.residual = own.residual[problem.rows][:, self.joints].T.ravel()

    def free(self, form: Form, places: np.ndarray) -> np.ndarray:
        """Its torque freed of what the model takes up, (m, R), at points (m, 4) of the unit cube."""
        known = {p.name: p.decode(places[:, k, None]) for k, p in enumerate(_CONSTANTS)}
        parts = [
            size * evaluate(program, {**self.data, **known}, np) * weight
            for program, size, weight in zip(
                (form.own, form.partners), form.sizes(known["e"]), self.weight, strict=False
            )
        ]
        column = np.concatenate(parts, axis=1)
        return column - (column @ self.basis) @ self.basis.T

    def shares(self, form: Form, places: np.ndarray) -> np.ndarray:
        """Share (m,) of the residual's square that it takes off."""
        free = self.free(form, places)
        size = np.maximum((free**2).sum(axis=1), 1e-300)
        return (free @ self.residual) ** 2 / size / (self.residual @ self.residual)

    def refined(self, form: Form, place: np.ndarray) -> tuple[float, np.ndarray]:
        """The least squares that it leaves nearby, and where."""

        def left(u: np.ndarray) -> np.ndarray:
            free = self.free(form, u[None])[0]
            size = max(float(free @ free), 1e-300)
            return self.residual - free * (free @ self.residual) / size

        found = scipy.optimize.least_squares(left, place, bounds=(0.0, 1.0), max_nfev=_STEPS)
        return float(found.cost), found.x


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
