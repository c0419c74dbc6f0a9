"""The words for what a summary shows: plain sentences, what was found and what to do about it."""

import numpy as np

from jaxswarm.logs.sampling import Gap
from jaxswarm.logs.summary import JointSummary, LogSummary

_IRREGULAR = 0.02
_SLOW_RATE = 20.0
# Beyond two turns an angle in radians is unusual, in degrees it is not.
_FAR = 4 * np.pi
_DEGREES = 180.0 / np.pi
_HELD = 0.05
_STANDSTILL = 0.5
# Steps beyond this share of the range are coarse.
_COARSE = 0.01


def describe(summary: LogSummary) -> tuple[str, ...]:
    """Say what a user should know about a log; a clean log gives no sentences.

    Args:
        summary: Numbers from :func:`jaxswarm.logs.summarize`.

    Returns:
        Sentences, those about the clock first, then one group per joint.
    """
    sentences = _clock(summary)
    if summary.held_share > _HELD:
        sentences.append(
            f"{100 * summary.held_share:.0f} % of the samples repeat the one before: the log is "
            "faster than its source. Log at the source's rate."
        )
    if summary.moving_share < _STANDSTILL:
        sentences.append(
            f"The robot stands still in {100 * (1 - summary.moving_share):.0f} % of the samples."
        )
    for joint in summary.joints:
        sentences += _joint(joint)
    return tuple(sentences)


def _clock(summary: LogSummary) -> list[str]:
    clock = summary.sampling
    sentences = []
    if clock.jitter > _IRREGULAR:
        sentences.append(
            f"Sampling is irregular: {clock.rate:.4g} Hz on the mean, periods from "
            f"{1e3 * clock.shortest:.3g} to {1e3 * clock.longest:.3g} ms, jitter "
            f"{100 * clock.jitter:.0f} %."
        )
    if clock.rate < _SLOW_RATE:
        sentences.append(f"{clock.rate:.3g} Hz is slow for a moving robot. Is t in seconds?")
    gaps = [gap for gap in clock.gaps if not gap.clock_jump]
    jumps = [gap for gap in clock.gaps if gap.clock_jump]
    if gaps:
        sentences.append(f"{len(gaps)} gap{'s' * (len(gaps) > 1)} in time: {_places(gaps)}.")
    if jumps:
        sentences.append(
            f"The clock jumps {len(jumps)} time{'s' * (len(jumps) > 1)} while the motion goes on: "
            f"{_places(jumps)}. Velocities are wrong there: split the log or mend t."
        )
    return sentences


def _places(gaps: list[Gap]) -> str:
    shown = ", ".join(f"{gap.length:.3g} s after t = {gap.start:.6g} s" for gap in gaps[:3])
    return shown + (f" and {len(gaps) - 3} more" if len(gaps) > 3 else "")


def _joint(joint: JointSummary) -> list[str]:
    name = joint.name
    sentences = []
    largest = max(abs(joint.position_min), abs(joint.position_max))
    if not joint.moves:
        sentences.append(
            f"{name} never moves (range {joint.position_max - joint.position_min:.2g})."
        )
    elif joint.reversals == 0:
        sentences.append(f"{name} never reverses: Coulomb friction and an offset look alike.")
    if largest > _FAR:
        sentences.append(
            f"{name} reaches {largest:.4g}: positions must be in rad or m. If these are degrees or "
            "mm, convert them."
        )
    if joint.wraps:
        sentences.append(
            f"{name} steps by a full turn {joint.wraps} time{'s' * (joint.wraps > 1)}: unwrap the "
            "angle."
        )
    sentences += _velocity(name, joint.velocity_ratio)
    if joint.stuck:
        sentences.append(
            f"The torque of {name} keeps one value for {joint.stuck} samples while the joint moves."
        )
    if joint.saturated:
        sentences.append(
            f"The torque of {name} sits at its limit (range {joint.torque_min:.4g} to "
            f"{joint.torque_max:.4g}) in {joint.saturated} samples: saturated, the true torque may "
            "differ."
        )
    coarse = joint.torque_quantum
    low, high = joint.torque_min, joint.torque_max
    if coarse and low is not None and high is not None and coarse > _COARSE * (high - low):
        sentences.append(f"The torque of {name} is quantized in steps of {coarse:.3g}.")
    coarse = joint.position_quantum
    if joint.moves and coarse > _COARSE * (joint.position_max - joint.position_min):
        sentences.append(f"The position of {name} is quantized in steps of {coarse:.3g}.")
    return sentences


def _velocity(name: str, ratio: float | None) -> list[str]:
    if ratio is None or abs(ratio - 1.0) < 0.1:
        return []
    hints = {
        _DEGREES: " (degrees?)",
        1 / _DEGREES: " (q in degrees?)",
        -1.0: " (sign?)",
        1e3: " (mm/s?)",
    }
    hint = next((text for value, text in hints.items() if abs(ratio / value - 1.0) < 0.05), "")
    return [
        f"The logged velocity of {name} is {ratio:.3g} times the derivative of its position{hint}."
    ]
