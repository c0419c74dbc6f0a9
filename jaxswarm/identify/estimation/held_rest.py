"""Which joints dry friction holds at rest: those whose rest neither the declared model nor their sign tells."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy

from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.factors import triangular_factor
from jaxswarm.identify.estimation.free_parameters import Place, width_parameter
from jaxswarm.identify.estimation.gauss_newton import newton, settle
from jaxswarm.identify.estimation.problem import Problem
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
# What motion tells of a parameter, over what all rows do, below which it tells nothing.
_UNSEEN = 1e-6
# Rest that motion predicts so many times worse than itself tells the model, whatever holds it: by standard
# errors 1.0 on point-to-point motion, 1.0 to 300 on joints that move one by one. Without such rest a model that
# left 0.1 to 1.5 times the noise was off by thousands of times the noise on other motion.
_TOLD = 2.0


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
        found = held(left, rest, mixed) & _foretold(every.columns, left, np.concatenate(mixed))
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
    alone = _rms_in_motion(left, resting)
    while (open_ := asked & ~untold).any():
        logs = leave_out(motions, rest, out | untold)
        problem = replace(whole, motions=tuple(logs))
        own = [
            width_parameter((j,), width_range(motions, (j,)))
            for j in np.flatnonzero(open_).tolist()
        ]
        told = newton(problem, own, settle(problem, place, pi)).residual
        paid = np.where(open_, _rms_in_motion(told, resting) / alone, 0.0)
        still = open_ & held(np.where(resting, told, left), rest, mixed)
        if not still.any():
            still = (paid == paid.max()) & (paid > _WORSE)
        if not still.any():
            break
        untold |= still
    return untold


def _foretold(columns: np.ndarray, left: np.ndarray, resting: np.ndarray) -> np.ndarray:
    """Whether motion predicts most of a joint's rest about as well as motion itself, (n,).

    Args:
        columns: Of the model, (T, n, p).
        left: What the fit to motion alone leaves, (T, n).
        resting: Rows at rest, (T, n).
    """
    # A joint that never moves tells nothing of the model, and has no error in motion.
    size = np.where(resting.all(axis=0), np.inf, _rms_in_motion(left, resting))
    # A joint at a time: beside the columns of a long log, as large as all else, no copy of them stands.
    squares = [((columns[:, j] / one) ** 2).sum(axis=0) for j, one in enumerate(size)]
    norm = np.sqrt(np.sum(squares, axis=0))
    seen = norm > 0.0

    def scaled(j: int, rows: np.ndarray) -> np.ndarray:
        return columns[rows, j][:, seen] / (size[j] * norm[seen])

    factor = _UNSEEN * np.eye(int(seen.sum()))
    for j, still in enumerate(resting.T):
        factor = triangular_factor(np.concatenate([factor, scaled(j, ~still)]))
    doubt = np.zeros(left.shape)
    for j, still in enumerate(resting.T):
        if not still.any():
            continue
        unseen = scipy.linalg.solve_triangular(
            factor, scaled(j, still).T, trans="T", check_finite=False
        )
        doubt[still, j] = np.sqrt(1.0 + (unseen**2).sum(axis=0))
    usual = [np.median(d[r]) if r.any() else 0.0 for d, r in zip(doubt.T, resting.T, strict=True)]
    return np.array(usual) <= _TOLD


def _rms_in_motion(left: np.ndarray, resting: np.ndarray) -> np.ndarray:
    """RMS (n,) of what is left (T, n) on rows that are not at rest, where there are any."""
    count = np.maximum((~resting).sum(axis=0), 1)
    return np.sqrt(np.where(resting, 0.0, left**2).sum(axis=0) / count) + 1e-300
