"""What a model takes up by bending: the widths of its signs, and the times at which something in it changes."""

from collections.abc import Iterator

import numpy as np

from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.free_parameters import (
    FreeParameter,
    Place,
    free_parameters,
    tangents,
    width_parameter,
)
from jaxswarm.identify.estimation.problem import Problem
from jaxswarm.identify.estimation.sign_width import width_groups, width_range
from jaxswarm.identify.forward.model import linear_values

# Standard deviation [s] by which the time of a change is known beside a law that is missing: a torque that is
# late moves it by as much, and those that are told as a delay are late by some ten milliseconds.
_TIME = 0.05


def bends(found: Estimate) -> np.ndarray:
    """Derivatives of the model by all that it may bend in, over how well that is known, (T, n, m)."""
    return np.concatenate([width_slopes(found), time_slopes(found)], axis=2)


def width_slopes(found: Estimate) -> np.ndarray:
    """Derivatives of the model by the logarithm of the width of every joint's own sign, (T, n, m).

    Joints share a width in the fit. That of one joint may be another, and a law that is bent into the
    difference must not be credited with it. It is known within a factor of e, one standard deviation: of
    true stiction a few rows tell it, and half of a log without them went off by 380 times the noise where
    they were, beside which nothing else could be seen.
    """
    model, motions = found.model, found.motions
    moving = [
        width_parameter((j,), width_range(motions, group))
        for group in width_groups(model.robot, model.terms, motions)
        for j in group
    ]
    moving = [one for one in moving if one.lower < model.width[one.joints[0]] < one.upper]
    return _slopes(found, moving, np.log([one.upper / one.lower for one in moving]))


def time_slopes(found: Estimate) -> np.ndarray:
    """Derivatives of the model by the times at which something in it changes, over their doubt, (T, n, m).

    Such a time gives way to what is late. Of a slide that picked up 15 kg with its torque 11 ms late, the jump
    was found where that put it, and told a delay of 0.7 ms: "partly explained", 2.8 times the noise.
    """
    moving, values = [], []
    for free in free_parameters(found.model.terms):
        assert free.term is not None
        term = found.model.terms[free.term]
        if free.name in _times(term) and free.lower < term.values[free.name] < free.upper:
            moving.append(free)
            values.append(term.values[free.name])
    given = zip(moving, values, strict=True)
    per = [one.parameter.encode(t + _TIME) - one.parameter.encode(t) for one, t in given]
    return _slopes(found, moving, 1.0 / np.array(per))


def _times(term: Term) -> Iterator[str]:
    """Parameters of a term that are times at which its torque changes."""
    law = term.law
    if law.begins is not None:
        yield law.begins
    if isinstance(law, BodyChange) and law.window:
        yield from ("start", "end")


def _slopes(found: Estimate, moving: list[FreeParameter], per: np.ndarray) -> np.ndarray:
    """Derivatives of the model by free parameters on their own scale, over so much each, (T, n, m)."""
    model = found.model
    if not moving:
        return np.zeros((*found.regression.torque.shape, 0))
    problem = Problem(model.robot, found.motions, found.rigids, False)
    pi, theta = np.asarray(model.robot.parameters).ravel(), linear_values(model)
    slopes = tangents(
        lambda place, free: problem.output(place, pi, theta, free),
        Place(model.terms, model.width),
        moving,
    )
    return slopes / per
