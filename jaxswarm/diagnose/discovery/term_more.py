"""A term more beside those of a sum: the best programs, all constants refined, and whether one is needed."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.discovery.front import Point, point
from jaxswarm.diagnose.discovery.pieces import Piece
from jaxswarm.diagnose.discovery.problem import Joint
from jaxswarm.diagnose.discovery.reach import tame
from jaxswarm.diagnose.discovery.screening import screen
from jaxswarm.diagnose.discovery.sums import Sum, joined, polished, without_idle

# Programs of which a term more is tried.
_TRIED = 30
# What is left within this share of the squared error, a twentieth of the torque, is the doubt of the motion
# that a law is computed from: on a drag of two joints it was 0.0019, and two terms of no meaning fitted it.
_DOUBT = 0.0025
# Share of the squared error that what explodes behind its range may leave beyond the noise where it was not
# fitted: with q^2 dq^3 abs(q_o - c) among two terms it was 0.003, and 0.09 with the best of those that do not.
# Of a joint at 5 times its noise the noise is 0.04: dq^5 load0^2 left 0.05, the best of those that do not 0.09.
_SURELY = 0.02
# Multiple of the noise below which a residual on other motion is not searched for more.
_NEAR = 1.5


def one_more(
    problem: Joint,
    pieces: Sequence[Piece],
    lead: Sum | None,
    folds,
    seed: int,
    tried: int = _TRIED,
    wild: bool = False,
) -> list[Point]:
    """The best programs beside those of a lead, all constants refined.

    Args:
        problem: The joint.
        pieces: The programs.
        lead: The terms beside them; None: there are none.
        folds: The regions, see :func:`region_folds`.
        seed: Of the swarms.
        tried: How many of the best are refined beside the lead.
        wild: Whether what is not :func:`believed` may be among them, as a step on the way to what is.
    """
    whole = problem.lin.crossfit.whole
    if lead is None:
        fold = whole
    else:
        fold = whole.with_columns(problem.columns(lead.programs, lead.values))
    trials = [t for t in screen(problem, fold, pieces, seed) if t.share > 0.0]
    sums = [polished(problem, joined(lead, trial), whole) for trial in trials[:tried]]
    done = [point(problem, without_idle(problem, formula), folds) for formula in sums]
    return [p for p in done if np.isfinite(p.error) and (wild or believed(problem, p))]


def believed(problem: Joint, one: Point) -> bool:
    """Whether a formula stays within bounds behind its range, or explains all there is where it was not fitted.

    A law may explode after all, as a product of high powers of three variables does.
    """
    if tame(problem, one.formula):
        return True
    of_noise = min(1.0, _over_noise(problem, one) ** -2)
    return one.error * (1.0 - of_noise) < _SURELY and explained(problem, one)


def explained(problem: Joint, best: Point) -> bool:
    """Whether nothing that is surely torque is left."""
    return best.error < _DOUBT or _over_noise(problem, best) < _NEAR


def _over_noise(problem: Joint, best: Point) -> float:
    """RMS of what is left on other motion over the noise."""
    crossfit, j = problem.lin.crossfit, problem.joint
    weight = np.maximum(crossfit.weight[:, j], 1e-300)
    left = np.sqrt(np.mean((best.left / weight) ** 2))
    return float(max(left, 1e-300) / crossfit.noise[j])
