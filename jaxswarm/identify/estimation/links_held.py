"""A fit with its links where they are, and its log read and written as it is; what depends on signs as it is.

A lag follows from the rigid parameters, a filter of the torque or an encoder's error from its own, and each fit
with one moves the links or makes all columns some times and builds all rows anew. What the widths of signs and
the shapes of laws change is a few columns. Which widths a log tells is asked of some ten such fits in a row,
and none of them moves a link, or a filter, by more than its own doubt: on a log of 36,000 samples, with
backlash, they took 15 to 45 s of fits of 20 to 50, on seven joints with a filter half of fits of 50 s. Of a
wrist whose one joint turns another, beside a dead zone, they took four fifths of 51 s.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.identify.estimation.free_parameters import FreeParameter, Place
from jaxswarm.identify.estimation.gauss_newton import Settled
from jaxswarm.identify.estimation.problem import Problem
from jaxswarm.identify.forward.body import moves_links
from jaxswarm.identify.forward.measuring_chain import term_block, uses_load
from jaxswarm.identify.forward.regression import Regression


def links_can_be_held(terms: tuple[Term, ...]) -> bool:
    """Whether links move, or logs are read and written, by parameters of a model, and no law sees its load."""
    return bool(moves_links(terms) or of_kind(terms, MeasurementLaw)) and not uses_load(terms)


@dataclass(frozen=True)
class LinksHeld(Problem):
    """A problem about a fit: rigid columns are its tangents, those of laws are made anew where they change.

    Attributes:
        at: The fit.
    """

    at: Settled | None = None

    @classmethod
    def about(cls, problem: Problem, at: Settled) -> "LinksHeld":
        """A problem with its links where a fit has them."""
        return cls(**{f.name: getattr(problem, f.name) for f in fields(problem)}, at=at)

    def free(
        self, terms: tuple[Term, ...], widths: Sequence[FreeParameter] = ()
    ) -> list[FreeParameter]:
        """All that may move but for what moves links, or the whole torque."""
        every = super().free(terms, widths)
        return [one for one in every if self._moved(Place(terms, ()), one) is not None]

    def build(self, place: Place, pi) -> Regression:
        """The rows of the fit with the columns of the laws that changed; ``pi`` changes none."""
        assert self.at is not None
        rows, former = self.at.regression, self.at.place
        columns, k = rows.columns.copy(), 10 * self.robot.num_joints
        for one, two in zip(former.terms, place.terms, strict=True):
            size = len(two.columns(self.robot.joints))
            if _bent_by(one, former.width) != _bent_by(two, place.width):
                own = [
                    term_block(self.robot, place.terms, two, motion, place.width, pi, rigid)
                    * two.acts_in(number)
                    for number, (motion, rigid) in enumerate(
                        zip(self.motions, self.rigids, strict=True)
                    )
                ]
                columns[:, :, k : k + size] = rows.counted(np.concatenate(own))
            k += size
        return replace(rows, columns=columns)

    def left(self, rows: Regression, place: Place, theta: np.ndarray) -> np.ndarray:
        """What the rows leave (T, n) with linear parameters (p,)."""
        return rows.target - rows.columns @ theta


def _bent_by(term: Term, width: Sequence[float]) -> tuple:
    """What the columns of a law go by."""
    own = tuple(term.values.get(p.name) for p in term.law.nonlinear)
    return (own, width[term.index] if term.law.uses_direction else None)
