"""All torques late or early by more than a model takes: motion and torques were logged by two clocks.

Up to 0.05 s it is a law (``time_delay``). A filter that all torques pass (``torque_lag``) looks as
late as its time constant; where it leaves no more than clocks do, both are told and the log goes on.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import scipy

from jaxswarm.identify.checks.guess import Guess
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.samples import Samples
from jaxswarm.identify.checks.sound import Tried
from jaxswarm.robot.model import Robot

LATE = "late_torque"
# Times [s] by which torques are moved to see whether that gains, each twice the one before; a tenth is beyond
# the law, and a tenth of the period of motion of 1 Hz.
_FIRST, _LAST = 0.1, 1.6
# Time [s] to which the best one is narrowed, and from which on it is told: the law's 0.05 and a little.
_WIDTH, _LEAST = 0.002, 0.055
# What it has to gain, as a sum of logarithms, for every joint, times the strictness of few rows. Torques of 108
# right logs moved by a tenth of a second and more gained nothing, but cost 0.05 to 3 a joint.
_GAIN = 0.1
# A filter leaves as little to this difference for every joint, at one of these time constants over the time by
# which it looks late: it holds back fast motion less than slow one.
_SAME, _CONSTANTS = 0.05, (1.0, 1.25, 1.6)
# Rows of one stretch are at most so many usual steps apart.
_GAP = 1.5


def clock_guesses(robot: Robot, rough: Rough, logged: Tried) -> Iterator[tuple[Guess, Tried]]:
    """The time by which all torques are late, if it leaves clearly less than the log as it is.

    Args:
        robot: Kinematics.
        rough: Model of the log as it is.
        logged: What that leaves.
    """
    known: dict[float, Tried] = {}

    def left(seconds: float) -> float:
        moved = shifted(rough.samples, seconds)
        if 2 * len(moved.t) < len(rough.samples.t):
            return np.inf  # of short stretches little is left to compare
        known[seconds] = Rough(robot, moved).as_logged()[0]
        return known[seconds].power

    low, side = min((left(side), side) for side in (-_FIRST, _FIRST))
    if low > logged.power:
        return
    while abs(side) < _LAST and (further := left(2.0 * side)) < low:
        low, side = further, 2.0 * side
    ends = sorted((0.5 * side, 2.0 * side))
    scipy.optimize.minimize_scalar(left, bounds=ends, method="bounded", options={"xatol": _WIDTH})
    seconds = min(known, key=lambda one: known[one].power)
    found = known[seconds]
    if abs(seconds) > _LEAST:
        alike = found.power + _SAME * robot.num_joints
        filtered = seconds > 0.0 and _filtered(robot, rough.samples, seconds) < alike
        needed = _GAIN * robot.num_joints * rough.strictness
        yield _guess(robot, seconds, filtered, needed), found


def shifted(samples: Samples, seconds: float) -> Samples:
    """Every motion with the torque so much later (earlier below zero), where both are of one stretch."""
    t, later = samples.t, samples.t + seconds
    before = np.clip(np.searchsorted(t, later, side="right") - 1, 0, len(t) - 2)
    steps = np.diff(t)
    inside = (later >= t[before]) & (later <= t[before + 1])
    kept = inside & (steps[before] < _GAP * np.median(steps))
    torque = scipy.interpolate.CubicHermiteSpline(t, samples.tau, samples.tau_rate)
    return replace(
        samples,
        t=t[kept],
        q=samples.q[kept],
        dq=samples.dq[kept],
        ddq=samples.ddq[kept],
        tau=torque(later[kept]),
        tau_rate=torque(later[kept], 1),
    )


def _filtered(robot: Robot, samples: Samples, seconds: float) -> float:
    """What is left at best of torques freed of a first-order filter that looks so late."""
    freed = (samples.tau + k * seconds * samples.tau_rate for k in _CONSTANTS)
    return min(Rough(robot, replace(samples, tau=x)).as_logged()[0].power for x in freed)


def _guess(robot: Robot, seconds: float, filtered: bool, needed: float) -> Guess:
    by = f"{abs(seconds):.2f} s {'late' if seconds > 0 else 'early'}"
    or_filtered = ", or pass a filter of that time constant" if filtered else ""
    return Guess(
        LATE,
        f"all torques are {by} against the motion{or_filtered}",
        tuple(range(robot.num_joints)),
        motion=lambda samples: shifted(samples, seconds),
        remedy=f"Move the torques by {-seconds:.2f} s, or log both by one clock",
        needed=needed,
        told_only=filtered,
    )
