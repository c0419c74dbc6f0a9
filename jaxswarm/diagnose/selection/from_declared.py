"""The final model fitted once more from where the declared one stands: its widths and its clocks.

Clocks and widths of the signs lean on each other and have more than one minimum: a torque read early looks like
a sharp sign. The loop meets both before anything is added, one after the other, and may end in the worse one,
where the declared model alone does not. On a world (w2735) all widths came out as 0.0022 rad/s where 0.0024 to
0.014 are true, the squared error 3 % larger, and the error on point-to-point motion ten times the declared
model's.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import jax
import numpy as np

from jaxswarm import cores
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.clock_skew import estimate_with_clocks, with_clocks
from jaxswarm.identify.estimation.estimate import Estimate, estimate
from jaxswarm.identify.estimation.least_squares import weighted_cost
from jaxswarm.identify.forward.columns import is_kept
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.shifted import with_skew_of
from jaxswarm.robot.model import Robot

# Widths whose logarithms are nearer lie in one valley, as where a fit is trusted to have found them by itself.
_NEAR = 0.3
# A fall of the weighted squares that one more parameter brings by chance once in twenty logs.
_CHANCE = 4.0


@contextmanager
def declared_alone(
    robot: Robot, declared: tuple[Term, ...], motions: Sequence[Motion]
) -> Iterator[Callable[[], Estimate]]:
    """The fit of the declared model that ``identify`` makes, with its clocks, found beside the selection.

    It is asked for at the end, whatever was added, and follows from nothing before that. Two fits of a long log
    do not stand in memory together: it waits until it is asked for.

    Args:
        robot: Kinematics.
        declared: Terms the user knows of.
        motions: Prepared logs, their clocks as read.
    """

    def found() -> Estimate:
        with jax.enable_x64(True):  # a thread has settings of its own
            return estimate_with_clocks(robot, declared, list(motions))

    if not all(map(is_kept, motions)):
        yield found
        return
    with cores.beside(found) as told:
        yield told


def fit_from_declared(search: Search, alone: Callable[[], Estimate]) -> None:
    """Replace the current fit by the one from the declared model's widths and clocks, where that is better.

    Args:
        search: With everything added.
        alone: Gives the fit of the declared model, :func:`declared_alone`.
    """
    current = search.current
    terms = current.model.terms
    directed = any(t.law.uses_direction for t in terms)
    if not directed or any(isinstance(t.law, MeasurementLaw) and t.law.clock for t in terms):
        return
    told = alone()
    width, like = told.model.width, told.motions[0]
    del told
    if np.abs(np.log(np.divide(width, current.model.width))).max() < _NEAR:
        return
    again = with_clocks(_fit_at(current, width, like))
    sigma = current.fit.sigma
    if weighted_cost(again.fit.residual, sigma) + _CHANCE < weighted_cost(
        current.fit.residual, sigma
    ):
        search.go_on(again)


def _fit_at(current: Estimate, width: tuple[float, ...], like: Motion) -> Estimate:
    """The current terms fitted from other widths, to logs by the clocks of another."""
    model = current.model
    return estimate(
        model.robot,
        model.terms,
        tuple(with_skew_of(m, like) for m in current.motions),
        width=width,
        refine_width=True,
        bounded=False,
        start=np.asarray(model.robot.parameters).ravel(),
        near=model.terms,
    )
