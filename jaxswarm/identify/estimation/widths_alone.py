"""What a log tells of the width of every joint's sign alone, and which joints it has to be fitted of."""

from collections.abc import Mapping, Sequence

import numpy as np

from jaxswarm.identify.estimation.free_covariance import apart_from
from jaxswarm.identify.estimation.free_parameters import FreeParameter, width_parameter
from jaxswarm.identify.estimation.gauss_newton import Settled
from jaxswarm.identify.estimation.own_widths import apart
from jaxswarm.identify.estimation.problem import Problem
from jaxswarm.identify.estimation.sign_width import width_range
from jaxswarm.logs.motion import Motion

# Where a width begins beyond its range, that ends so many times further.
_BEYOND = 1.01

# Of joints: the logarithm of a width and its standard error.
Alone = dict[int, tuple[float, float]]


def free_widths(
    motions: Sequence[Motion], parts: Sequence[tuple[int, ...]], width: Sequence[float]
) -> list[FreeParameter]:
    """The widths to fit; a sign that is sharper than any sample shows has none.

    One that is beyond all that its joints' motion shows begins there, and may come back: it is that of other
    joints. One that crept kept 0.014 rad/s by being held where 0.0090 +- 0.0002 was told, and was given a
    Stribeck law of 0.7 of its friction on a clean log.

    Args:
        motions: Of the logs.
        parts: Joints that share a width.
        width: Of every joint, (n,).
    """
    begins = [width[part[0]] for part in parts]
    ranges = [width_range(motions, part) for part in parts]
    return [
        width_parameter(part, (low, max(high, _BEYOND * begin)))
        for part, begin, (low, high) in zip(parts, begins, ranges, strict=True)
        if low < begin
    ]


def widths_alone(problem: Problem, here: Settled, groups: Sequence[Sequence[int]]) -> Alone:
    """What the width of every joint that shares one by its kind would be alone, to first order, with its error.

    Logarithms both; a width at a limit is not told, and its error is infinite. Nothing where none is told.
    """
    every = [
        width_parameter((j,), width_range(problem.motions, group))
        for group in groups
        if len(group) > 1
        for j in group
    ]
    alone = [one for one in every if one.lower < here.place.width[one.joints[0]] < one.upper]
    if not alone:
        return {}
    untold = {
        one.joints[0]: (float(np.log(here.place.width[one.joints[0]])), np.inf) for one in every
    }
    change, doubt = apart_from(problem, alone, here)
    scale = np.array([np.log(one.upper / one.lower) for one in alone])
    now = np.log([here.place.width[one.joints[0]] for one in alone])
    rows = zip(now + change * scale, doubt * scale, strict=True)
    found = {one.joints[0]: (float(y), float(v)) for one, (y, v) in zip(alone, rows, strict=True)}
    return untold | found


def freed_of(
    groups: Sequence[tuple[int, ...]],
    own: Mapping[int, tuple[float, float]],
    width: Sequence[float],
) -> set[int]:
    """The joints whose sign is another than that of their kind, beyond doubt."""
    freed = set()
    for group in groups:
        rows = [j for j in group if j in own and np.isfinite(own[j][1])]
        ratio = np.array([own[j][0] - np.log(width[j]) for j in rows])
        freed |= {rows[k] for k in apart(ratio, np.array([own[j][1] for j in rows]))}
    return freed
