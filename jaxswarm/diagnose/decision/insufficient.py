"""Logs that cannot decide anything, and what they lack; said as a result, not as an error."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.decision.verdict import CANNOT, NO_PROOF
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot

# Least number of independent rows per parameter, and least time [s], to hold blocks of time out.
_ROWS_PER_PARAMETER, _SECONDS = 3.0, 2.0
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


def too_short(motions: Sequence[Motion], parameters: int) -> list[str]:
    """Sentences on logs with too few independent samples for a decision on held-out time."""
    rows = sum(len(m.decimator.kept(len(m.t))) * m.q.shape[1] for m in motions)
    seconds = sum(float(m.t[-1] - m.t[0]) for m in motions)
    reasons = []
    if rows < _ROWS_PER_PARAMETER * parameters:
        reasons.append(
            f"{rows} independent samples below {motions[0].torque_cutoff:.3g} Hz are too few for "
            f"{parameters} parameters and a part to test on; log at least "
            f"{seconds * _ROWS_PER_PARAMETER * parameters / max(rows, 1):.0f} s of exciting motion"
        )
    elif seconds < _SECONDS:
        reasons.append(
            f"{seconds:.2g} s are too short to hold blocks of time out; log at least {_SECONDS:g} s"
        )
    return reasons


def undecidable(
    robot: Robot, declared: list[dict], units: Sequence[str], reasons: list[str]
) -> dict:
    """``diagnosis.json`` where nothing could be asked: nothing added, and why."""
    return {
        "robot": robot.name,
        "joints": list(robot.joints),
        "declared": declared,
        "effects": [],
        "changed": [],
        "steps": [],
        "removed": [],
        "unexplained": [],
        "undecided": [],
        "error": {"before": None, "after": None, "noise_floor": None},
        "torque_units": list(units),
        "verdict": CANNOT,
        "proof": NO_PROOF,
        "residual_over_noise": [],
        "discovered": [],
        "budget": None,
        "reasons": list(reasons),
        "asked": 0,
        "not_added": [],
    }
