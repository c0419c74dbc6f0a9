"""Motion that tells too little of the arm, and what it lacks."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot

# Name by which a user goes on in spite of it.
WEAK = "weak_motion"
# Least number of independent rows per parameter, and least time [s], to hold blocks of time out.
_ROWS_PER_PARAMETER, _SECONDS = 3.0, 2.0
# The same of a fit alone: with fewer rows than parameters any noise is fitted, and the ends of a log are a part
# of a second.
_ROWS_OF_A_FIT, _SECONDS_OF_A_FIT = 1.0, 1.0
# Least travel [rad or m] of a joint that moves.
_LEAST_TRAVEL = 1e-3


def resting_joints(motions: Sequence[Motion], robot: Robot) -> list[str]:
    """Sentences on joints that never move or never reverse: what that hides."""
    reasons = []
    for j, joint in enumerate(robot.joints):
        speed = np.concatenate([m.dq[:, j] for m in motions])
        travel = max(float(np.ptp(m.q[:, j])) for m in motions)
        if travel < _LEAST_TRAVEL:
            reasons.append(
                f"{joint} never moves: no effect on it can be seen; move it through its range"
            )
        elif not (
            (speed > 0.05 * np.abs(speed).max()).any()
            and (speed < -0.05 * np.abs(speed).max()).any()
        ):
            reasons.append(
                f"{joint} never reverses: dry friction cannot be told from an offset; move it both ways"
            )
    return reasons


def all_rest(motions: Sequence[Motion]) -> list[str]:
    """A sentence if no joint moves in any log: then any parameter fits."""
    if any((np.ptp(m.q, axis=0) > _LEAST_TRAVEL).any() for m in motions):
        return []
    return ["no joint moves: a standing arm tells nothing of its model; log a motion"]


def too_short(
    motions: Sequence[Motion],
    parameters: int,
    rows_each: float = _ROWS_PER_PARAMETER,
    least: float = _SECONDS,
) -> list[str]:
    """Sentences on logs with too few independent samples for a decision on held-out time."""
    rows = sum(len(m.decimator.kept(len(m.t))) * m.q.shape[1] for m in motions)
    seconds = sum(float(m.t[-1] - m.t[0]) for m in motions)
    reasons = []
    if rows < rows_each * parameters:
        reasons.append(
            f"{rows} independent samples below {motions[0].torque_cutoff:.3g} Hz are too few for "
            f"{parameters} parameters and a part to test on; log at least "
            f"{np.ceil(seconds * rows_each * parameters / max(rows, 1)):.0f} s of exciting motion"
        )
    elif seconds < least:
        reasons.append(
            f"{seconds:.2g} s are too short to hold blocks of time out; log at least {least:g} s"
        )
    return reasons


def refuse_weak(motions: Sequence[Motion], parameters: int, accept: Sequence[str]) -> None:
    """Refuse logs whose motion is too short or too little for a number of parameters.

    Args:
        motions: The prepared stretches of all fitted logs.
        parameters: How many are to be found.
        accept: Names of checks in spite of which the work goes on.

    Raises:
        InputError: With what the motion lacks.
    """
    lacks = all_rest(motions)
    lacks = lacks or too_short(motions, parameters, _ROWS_OF_A_FIT, _SECONDS_OF_A_FIT)
    if lacks and WEAK not in accept:
        raise InputError(
            f"{motions[0].source}: {WEAK}: {'; '.join(lacks)}. To go on all the same, pass --accept {WEAK}"
        )
