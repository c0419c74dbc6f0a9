"""Which joints dry friction holds at rest: those whose rest neither the declared model nor their sign tells."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.free_parameters import Place, width_parameter
from jaxswarm.identify.estimation.gauss_newton import newton, settle
from jaxswarm.identify.estimation.problem import Problem
from jaxswarm.identify.estimation.rest_foretold import is_foretold, rms_in_motion
from jaxswarm.identify.estimation.sign_width import width_range
from jaxswarm.identify.estimation.standing import held, leave_out, mixed_with, standing
from jaxswarm.identify.forward.columns import Rigid
from jaxswarm.identify.forward.regression import build_regression
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot

# Rest is no part of a model beside which it leaves so many times the RMS in motion. Where another width of the
# sign was right, on 13 joints of MuJoCo worlds, that was 0.2 to 1.1, and 1.2 on two of 51 and 100 rows; where
# joints with true stiction moved one by one 1.35 to 3.3 on eight of which rest had bent the rigid body.
_WORSE = 1.25


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
        place, pi, theta = _fitted(
            Problem(robot, tuple(trial), tuple(rigids), False), terms, width, pi
        )
        every = build_regression(robot, place.terms, motions, width, pi, rigids)
        left = every.target - every.columns @ theta
        found = held(left, rest, mixed) & is_foretold(every.columns, left, np.concatenate(mixed))
        del every  # of a long log the columns are as large as those of the fits to come
        # Where no friction is declared no sign has a width that could tell.
        own = {t.joint for t in terms if t.law.uses_direction}
        signed = np.array([j in own for j in range(robot.num_joints)])
        whole = Problem(robot, tuple(motions), tuple(rigids), False)
        asked, out = found & signed, found & ~signed
        found = out | _untold(asked, out, left, whole, place, pi)
    return leave_out(motions, rest, found)


def _fitted(
    problem: Problem, terms: tuple[Term, ...], width: tuple[float, ...], pi: np.ndarray
) -> tuple[Place, np.ndarray, np.ndarray]:
    """Where a fit ends, its rigid parameters (10 n,) and all linear ones (p,); its columns are let go of."""
    here = settle(problem, Place(terms, width), pi)
    return here.place, here.pi, here.theta


def _untold(
    asked: np.ndarray,
    out: np.ndarray,
    left: np.ndarray,
    whole: Problem,
    place: Place,
    pi: np.ndarray,
) -> np.ndarray:
    """Of joints that are asked, (n,), those whose rest no width of their own sign tells, (n,).

    Those go first whose rest is left as before, then, one by one, those whose motion pays most for it: what
    friction holds of one joint bends the rigid body of all. Of joints that moved one by one that told rest well
    enough, and left up to 29 times the noise on another log.

    Args:
        asked: Joints whose rest is more than what motion alone leaves of them.
        out: Further ones, (n,), of which rest is left out in any case.
        left: What the fit to motion alone leaves on all rows of the ``whole`` problem, (T, n).
        whole: All rows.
        place, pi: Where the fit to motion alone ended.
    """
    motions = whole.motions
    rest = standing(motions)
    mixed = mixed_with(motions, rest)
    resting, untold = np.concatenate(mixed), np.zeros_like(asked)
    alone = rms_in_motion(left, resting)
    while (open_ := asked & ~untold).any():
        logs = leave_out(motions, rest, out | untold)
        problem = replace(whole, motions=tuple(logs))
        own = [
            width_parameter((j,), width_range(motions, (j,)))
            for j in np.flatnonzero(open_).tolist()
        ]
        told = newton(problem, own, settle(problem, place, pi)).residual
        paid = np.where(open_, rms_in_motion(told, resting) / alone, 0.0)
        still = open_ & held(np.where(resting, told, left), rest, mixed)
        if not still.any():
            still = (paid == paid.max()) & (paid > _WORSE)
        if not still.any():
            break
        untold |= still
    return untold
