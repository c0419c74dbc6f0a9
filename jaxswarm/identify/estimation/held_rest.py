"""Which joints dry friction holds at rest: those whose rest neither the declared model nor their sign tells."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.free_parameters import Place, width_parameter
from jaxswarm.identify.estimation.gauss_newton import newton, settle
from jaxswarm.identify.estimation.problem import Problem
from jaxswarm.identify.estimation.sign_width import width_range
from jaxswarm.identify.estimation.standing import held, leave_out, mixed_with, standing
from jaxswarm.identify.forward.columns import Rigid
from jaxswarm.identify.forward.regression import build_regression
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot


def without_rest(
    robot: Robot,
    terms: tuple[Term, ...],
    motions: Sequence[Motion],
    rigids: Sequence[Rigid],
    width: tuple[float, ...],
    pi: np.ndarray,
) -> Sequence[Motion]:
    """The logs, where that is not known yet with the rest of joints left out that dry friction holds there.

    Where another width of its sign tells a joint's rest, friction does not hold it. Beside laws that two other
    joints lacked, the width of all was a tenth too sharp, and what a third one left at rest for that was taken
    for friction's, four times its error in motion: its width stayed, and was never asked.
    """
    if all(m.held is not None for m in motions):
        return motions
    rest = standing(motions)
    found = np.zeros(robot.num_joints, bool)
    if any(r.any() for r in rest):
        mixed = mixed_with(motions, rest)
        trial = [replace(m, held=r) for m, r in zip(motions, mixed, strict=True)]
        here = settle(Problem(robot, tuple(trial), tuple(rigids), False), Place(terms, width), pi)
        every = build_regression(robot, here.place.terms, motions, width, here.pi, rigids)
        left = every.target - every.columns @ here.theta
        found = held(left, rest, mixed)
        # Where no friction is declared no sign has a width that could tell.
        signed = {t.joint for t in terms if t.law.uses_direction}
        own = [
            width_parameter((j,), width_range(motions, (j,)))
            for j in np.flatnonzero(found).tolist()
            if j in signed
        ]
        if own:
            whole = Problem(robot, tuple(motions), tuple(rigids), False)
            told = newton(whole, own, settle(whole, here.place, here.pi))
            resting = np.concatenate(mixed)
            found &= held(np.where(resting, told.residual, left), rest, mixed)
    return leave_out(motions, rest, found)
