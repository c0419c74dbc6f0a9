"""What stays the same while a model is fitted: robot, logs and bounds."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from jaxswarm.effects.kinds import MeasurementLaw, TorqueLaw
from jaxswarm.effects.term import Term, of_kind, parameter_bounds
from jaxswarm.identify.estimation.free_parameters import FreeParameter, Place, free_parameters
from jaxswarm.identify.estimation.least_squares import Solved, solved
from jaxswarm.identify.estimation.link_inertia import link_inertias
from jaxswarm.identify.forward.body import moves_links
from jaxswarm.identify.forward.columns import Rigid
from jaxswarm.identify.forward.event_rows import event_columns
from jaxswarm.identify.forward.measuring_chain import low_torque_along, term_block
from jaxswarm.identify.forward.regression import Regression, build_regression
from jaxswarm.identify.forward.torque_prior import torque_prior
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot


@dataclass(frozen=True)
class Problem:
    """What stays the same while a model is fitted.

    Attributes:
        usual: Nonlinear parameters that stay at their usual values, by the number of their term and their name.
        inertias: Rows of :func:`link_inertias` by the terms' identities: every fit asks for the same.
        prior: Rows of :func:`torque_prior`, (r, 10 n); None: they are made.
    """

    robot: Robot
    motions: tuple[Motion, ...]
    rigids: tuple[Rigid, ...]
    bounded: bool
    usual: frozenset[tuple[int | None, str]] = frozenset()
    inertias: dict = field(default_factory=dict, repr=False, compare=False)
    prior: np.ndarray | None = field(default=None, repr=False, compare=False)

    def __post_init__(self):
        if self.prior is None:
            object.__setattr__(self, "prior", torque_prior(self.robot, self.motions))

    def free(
        self, terms: tuple[Term, ...], widths: Sequence[FreeParameter] = ()
    ) -> list[FreeParameter]:
        """All that may move beside the linear parameters, with the widths that are free."""
        every = free_parameters(terms, widths)
        return [one for one in every if (one.term, one.name) not in self.usual]

    def build(self, place: Place, pi) -> Regression:
        """The rows at a place."""
        logs = self.motions, place.width, pi, self.rigids
        return build_regression(self.robot, place.terms, *logs, prior=self.prior)

    def left(self, rows: Regression, place: Place, theta: np.ndarray) -> np.ndarray:
        """What a model leaves (T, n) of rows that were built with its terms, by its torque alone.

        Not finite where the model leaves the finite numbers.
        """
        told = np.array(theta, float)
        told[event_columns(self.robot, place.terms)] = 0.0
        with np.errstate(over="ignore", invalid="ignore"):
            model = self._torque(place, told[: 10 * self.robot.num_joints], told)
            return rows.torque - rows.counted(np.where(rows.used_rows, model, 0.0))

    def _torque(self, place: Place, pi: np.ndarray, theta: np.ndarray) -> np.ndarray:
        """Decimated torque (T, n) of all logs."""
        return np.concatenate(
            [
                low_torque_along(
                    self.robot, place.terms, motion, place.width, pi, theta, rigid, number
                )
                for number, (motion, rigid) in enumerate(
                    zip(self.motions, self.rigids, strict=True)
                )
            ]
        )

    def solve(
        self, terms: tuple[Term, ...], regression: Regression, near: np.ndarray | None = None
    ) -> Solved:
        """The linear parameters. How certain they are is asked of the last of many fits alone.

        ``near``: Weights of a fit near this one, (n,).
        """
        lower, upper = parameter_bounds(terms, self.robot.joints) if self.bounded else (None, None)
        known = tuple(t.identity for t in terms)
        if known not in self.inertias:
            self.inertias[known] = link_inertias(self.robot, terms, self.motions)
        above = self.inertias[known]
        if above is not None:
            others = len(regression.names) - above.shape[1]
            above = np.pad(above, ((0, 0), (0, others)))
        return solved(regression, lower, upper, above=above, near=near)

    def output(self, place: Place, pi, theta, free: FreeParameter) -> np.ndarray:
        """Decimated torque of a model, (T, n), but for what a free parameter does not change."""
        moved = self._moved(place, free)
        if moved is None:
            return self._torque(place, pi, theta)
        sizes = [len(t.columns(self.robot.joints)) for t in place.terms]
        ends = len(pi) + np.cumsum(sizes)
        parts = []
        for number, (motion, rigid) in enumerate(zip(self.motions, self.rigids, strict=True)):
            given = (motion, place.width, pi, rigid)
            parts.append(
                sum(
                    term_block(self.robot, place.terms, place.terms[k], *given)
                    @ (place.terms[k].acts_in(number) * theta[ends[k] - sizes[k] : ends[k]])
                    for k in moved
                )
            )
        return np.concatenate(parts)

    def _moved(self, place: Place, free: FreeParameter) -> list[int] | None:
        """Indices of the terms whose columns a free parameter changes; None: the whole model."""
        if free.term is None:
            return [
                k
                for k, t in enumerate(place.terms)
                if t.joint in free.joints and t.law.uses_direction
            ]
        law = place.terms[free.term].law
        misread = tuple(of_kind(place.terms, MeasurementLaw))
        # The motors move as the log says though links lag behind them, unless encoders say it wrong.
        felt = moves_links(place.terms if law.uses_load else misread)
        return [free.term] if isinstance(law, TorqueLaw) and not felt else None
