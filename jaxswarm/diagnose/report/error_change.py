"""How the error changed, as the first line tells it, and where it grew."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.report.numbers import percent
from jaxswarm.identify.forward.begun import ALL_ALONG, NOT_BEGUN

# Joints that the first line holds.
_MOST_JOINTS = 3


def error_change(result: dict) -> str:
    """Error of the whole arm before and after; first that of the joints with a law, where it hides their fall.

    A strong joint that a log says little of may change by more than a law takes off a weak one: an error
    that fell from 6.4 to 0.1 % of a wrist's torque stood beside 0.88 and 0.97 % of the whole arm's.
    """
    before, after = result["error"]["before"], result["error"]["after"]
    change = percent(before["relative_global"])
    added = [*result["effects"], *result["changed"]]
    if not (added or result["discovered"]):
        return change
    change += f" before, {percent(after['relative_global'])} after, on {after['on']}"
    if after["relative_global"] <= before["relative_global"]:
        return change
    own = {entry.get("joint") for entry in added}
    rows = zip(result["joints"], before["relative"], after["relative"], strict=True)
    told = [f"{j} {percent(one)} before, {percent(two)} after" for j, one, two in rows if j in own]
    return "; ".join([*told[:_MOST_JOINTS], f"whole arm {change}" if told else change])


def begun(validation: list[dict]) -> list[str]:
    """Sentences on what began in the fitted log and had not on a validation log, or was there all along."""
    told = {NOT_BEGUN: "had not begun", ALL_ALONG: "was there all along"}
    return [
        f"on {entry['on']} {one['effect']}@{one['joint']} {told[one['state']]}"
        for entry in validation
        for one in entry.get("begun", ())
    ]


def grown(
    validation: list[dict], joints: Sequence[str], noise: np.ndarray, harm: float
) -> list[str]:
    """Sentences on joints whose error on a validation log grew beyond the noise by what was added."""
    told = []
    for entry in validation:
        for joint, one, two, low in zip(
            joints, entry["before"]["rms"], entry["after"]["rms"], noise, strict=True
        ):
            if two > harm * one and two > low:
                told.append(
                    f"on {entry['on']} the error of {joint} grew from {one:.3g} to {two:.3g}"
                )
    return told
