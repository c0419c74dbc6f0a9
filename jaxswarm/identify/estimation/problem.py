"""What stays the same while a model is fitted: robot, logs and bounds."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.term import Term, parameter_bounds
from jaxswarm.identify.estimation.free_parameters import FreeParameter, Place, free_parameters
from jaxswarm.identify.estimation.least_squares import Solved, solved
from jaxswarm.identify.estimation.link_inertia import link_inertias
from jaxswarm.identify.forward.body import moves_links
from jaxswarm.identify.forward.columns import Rigid
from jaxswarm.identify.forward.measuring_chain import assemble, term_block
from jaxswarm.identify.forward.regression import (
    Regression,
    build_regression,
    with_slopes,
)
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot


@dataclass(frozen=True)
class Problem:
    """What stays the same while a model is fitted.

    Attributes:
        usual: Nonlinear parameters that stay at their usual values, by the number of their term and their name.
        inertias: Rows of :func:`link_inertias` by the terms' identities: every fit asks for the same.
    """

    robot: Robot
    motions: tuple[Motion, ...]
    rigids: tuple[Rigid, ...]
    bounded: bool
    usual: frozenset[tuple[int | None, str]] = frozenset()
    inertias: dict = field(default_factory=dict, repr=False, compare=False)

    def free(
        self, terms: tuple[Term, ...], widths: Sequence[FreeParameter] = ()
    ) -> list[FreeParameter]:
        """All that may move beside the linear parameters, with the widths that are free."""
        every = free_parameters(terms, widths)
        return [one for one in every if (one.term, one.name) not in self.usual]

    def build(self, place: Place, pi, bent: bool = True) -> Regression:
        """The rows at a place; not ``bent``: without how the torque bends there, for its size alone."""
        given = self.robot, place.terms, self.motions, place.width, pi, self.rigids
        return build_regression(*given, bent=bent)

    def bend(self, plain: Regression, place: Place, pi) -> Regression:
        """Rows that were made for their size alone, for a fit."""
        given = self.robot, place.terms, self.motions, place.width, pi, self.rigids
        return with_slopes(plain, *given)

    def solve(self, terms: tuple[Term, ...], regression: Regression) -> Solved:
        """The linear parameters. How certain they are is asked of the last of many fits alone."""
        lower, upper = parameter_bounds(terms, self.robot.joints) if self.bounded else (None, None)
        known = tuple(t.identity for t in terms)
        if known not in self.inertias:
            self.inertias[known] = link_inertias(self.robot, terms, self.motions)
        above = self.inertias[known]
        if above is not None:
            others = len(regression.names) - above.shape[1]
            above = np.pad(above, ((0, 0), (0, others)))
        return solved(regression, lower, upper, above=above)

    def output(self, place: Place, pi, theta, free: FreeParameter) -> np.ndarray:
        """Decimated torque of a model, (T, n), but for what a free parameter does not change."""
        moved = self._moved(place, free)
        sizes = [len(t.columns(self.robot.joints)) for t in place.terms]
        ends = len(pi) + np.cumsum(sizes)
        parts = []
        for number, (motion, rigid) in enumerate(zip(self.motions, self.rigids, strict=True)):
            given = (motion, place.width, pi, rigid)
            if moved is None:
                columns = assemble(self.robot, place.terms, *given, decimate=True, log=number)
                parts.append(columns @ theta)
                continue
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
        own = isinstance(place.terms[free.term].law, TorqueLaw)
        alone = own and not moves_links(place.terms)
        return [free.term] if alone else None
