"""Whether the channels of a log belong together: a velocity to its position, a torque to a motion.

What is logged twice, as a position and as its derivative, can be checked: over windows of a few tenths of
a second the change of one is the integral of the other. The position is believed, because the model is a
function of it; a derivative that contradicts it is left out with a note. A torque that never changes is
a dead channel.
"""

from dataclasses import replace

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.logs.log import Log
from jaxswarm.logs.quality import velocity
from jaxswarm.logs.sampling import sampling
from jaxswarm.logs.summary import summarize

# Length of the windows [s] over which a derivative is integrated.
_WINDOW = 0.2
# Changes below this many standard deviations of the position's own noise decide nothing.
_CLEAR = 10.0
# A derivative explains less than this share of the change, or scales it by more than the tolerance.
_EXPLAINED = 0.5
_TOLERANCE = 0.1
# A constant error of a velocity is told by stretches of a log, if it is beyond so many standard errors and
# more than a part of the joint's top speed.
_STRETCHES, _SURE, _MATERIAL = 20, 8.0, 2e-3
# Windows that a verdict needs.
_LEAST_WINDOWS = 20
# A joint that travels less [rad or m] is held where it stands.
_HELD = 1e-3


def drop_contradictions(log: Log) -> Log:
    """Leave out a logged velocity or acceleration that contradicts the position, with a note."""
    if (log.dq is None and log.ddq is None) or len(log.t) < 3:
        return log
    summary = summarize(log)
    moving = [k for k, joint in enumerate(summary.joints) if joint.moves]
    notes = []
    dq, ddq = log.dq, log.ddq
    if dq is not None:
        wrong = [k for k in moving if _contradicts(log, log.q[:, k], dq[:, k])]
        if wrong:
            notes.append(_note("velocity", "position", [log.joints[k] for k in wrong]))
            dq = None
        else:
            dq, told = _without_bias(log)
            notes += told
    if ddq is not None:
        speeds = {k: velocity(log.t, log.q[:, k]) if dq is None else dq[:, k] for k in moving}
        wrong = [k for k in moving if _contradicts(log, speeds[k], ddq[:, k])]
        if wrong:
            notes.append(_note("acceleration", "velocity", [log.joints[k] for k in wrong]))
            ddq = None
    return replace(log, dq=dq, ddq=ddq, notes=(*log.notes, *notes))


def _without_bias(log: Log) -> tuple[np.ndarray, list[str]]:
    """The velocities (T, n) without a constant by which they contradict the positions, and notes on it.

    Over a stretch of a log the mean velocity is the change of the position over its time. Smoothing believes
    the position at low frequencies, so that a constant would not be seen in the middle of a log; at its ends,
    where a velocity is half of what is known, it would bend the motion.
    """
    ends = np.linspace(0, len(log.t) - 1, _STRETCHES + 1).astype(int)
    given = np.asarray(log.dq)  # only logs with velocities come here
    if len(log.t) < 2 * _STRETCHES:
        return given, []
    time = np.diff(log.t)[:, None]
    way = np.concatenate([0.0 * given[:1], np.cumsum(0.5 * (given[1:] + given[:-1]) * time, 0)])
    apart = np.diff((way - log.q)[ends], axis=0) / np.diff(log.t[ends])[:, None]
    bias, doubt = apart.mean(axis=0), apart.std(axis=0, ddof=1) / np.sqrt(_STRETCHES)
    clear = (np.abs(bias) > _SURE * doubt) & (np.abs(bias) > _MATERIAL * np.abs(given).max(axis=0))
    notes = [
        f"The logged velocity of {log.joints[k]} is {bias[k]:.3g} rad/s (m/s) too large throughout: this is "
        "taken off. Zero its sensor at rest."
        for k in np.flatnonzero(clear)
    ]
    return given - np.where(clear, bias, 0.0), notes


def refuse_dead_torque(log: Log) -> None:
    """Refuse a torque of one value: nothing measured is without noise, and its weight would be infinite.

    Raises:
        InputError: Naming the joint.
    """
    if log.tau is None or len(log.tau) < 2:
        return
    dead = [j for j, torque in enumerate(log.tau.T) if np.ptp(torque) == 0.0]
    if dead:
        first, names = dead[0], ",".join(_held(log, j) for j in dead)
        raise InputError(
            f"{log.source}: the torque of {log.joints[first]} is {log.tau[0, first]:g} in every sample: the "
            f"channel is dead. Log it again, or hold what nobody moves still: --lock {names}"
        )


def _held(log: Log, joint: int) -> str:
    """A joint with the position it is held at, as ``--lock`` takes it; zero need not be written."""
    own = log.q[:, joint]
    position = float(np.median(own)) if np.ptp(own) < _HELD else 0.0
    return log.joints[joint] + (f"={position:.6g}" if position else "")


def _note(rate: str, of: str, joints: list[str]) -> str:
    return (
        f"The logged {rate} contradicts the {of} on {', '.join(joints)}: it is left out and "
        f"differentiated from the {of} instead. Check its order of joints, sign and unit."
    )


def _contradicts(log: Log, values: np.ndarray, rate: np.ndarray) -> bool:
    """Whether ``rate`` (T,), apart from a constant bias, is not the derivative of ``values`` (T,)."""
    found = sampling(log.t, log.q)
    period = np.diff(log.t)
    width = max(2, round(_WINDOW * found.rate))
    if len(values) < 2 * width:
        return False
    integral = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * period)])
    starts = np.arange(len(values) - width)
    whole = log.t[starts + width] - log.t[starts] < 2.0 * width / found.rate
    starts = starts[whole]
    if len(starts) < max(_LEAST_WINDOWS, width):
        return False
    change = values[starts + width] - values[starts]
    expected = integral[starts + width] - integral[starts]
    change, expected = change - change.mean(), expected - expected.mean()
    noise = np.median(np.abs(np.diff(values, 3))) / (0.6745 * np.sqrt(20.0))
    if change.std() < _CLEAR * noise or change.std() == 0.0:
        return False
    own = float(expected @ expected)
    if own == 0.0:
        return True
    slope = float(change @ expected) / own
    explained = slope * float(change @ expected) / float(change @ change)
    return explained < _EXPLAINED or abs(slope - 1.0) > _TOLERANCE
