"""``diagnosis.json`` of logs that cannot decide anything, and what they lack; a result, not an error."""

from collections.abc import Sequence

from jaxswarm.diagnose.decision.verdict import CANNOT, NO_PROOF
from jaxswarm.robot.model import Robot


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
