"""Channels that stop telling what they measure: a position that stands in a motion, a torque at its top."""

import numpy as np

from jaxswarm.logs.clipping import clipped
from jaxswarm.logs.filtering import white_noise
from jaxswarm.logs.finding import Finding
from jaxswarm.logs.log import Log, take
from jaxswarm.logs.quality import longest_run, quantum, slowest_motion, velocity
from jaxswarm.logs.runs import runs
from jaxswarm.logs.sampling import usual_period

STUCK, SATURATION = "stuck", "saturation"
# A position that is the same for so long [s], from a speed of this part of the joint's own top speed, or with
# such a jump at its end in usual steps: no joint stops or starts within one sample.
_LONG, _FAST, _JUMP = 0.15, 0.1, 3.0
# Samples before the stop that are all so fast, steps of the encoder that they have to be, and the quantile of
# all speeds that is the top.
_BEFORE, _QUANTA, _TOP = 3, 4.0, 0.95
# Beyond this share of a log there is too little left between the stretches.
_MOST_STUCK = 0.4
# A torque that repeats to the last digit for so long [s] has stopped being measured where its channel is noisy:
# its noise is above half its quantum (one sample in three differs) and this part of its range, and it repeats
# nowhere else for a tenth of that.
_LONG_TORQUE, _QUANTUM, _NOISY, _ELSEWHERE = 0.4, 0.5, 1e-5, 0.1
# Share of samples with a torque at its limit that may be left out: with 12 % the error on other motion grew by
# 3 % (it grew twelve times where they stayed in). Beyond this share the drives cannot make the motion.
_MOST_SATURATED = 0.15


def stuck_stretches(log: Log) -> list[tuple[int, int, int]]:
    """Joint, first and past-the-last sample of every stretch with a position that cannot be."""
    found = []
    least = max(int(round(_LONG / usual_period(log.t))), 3)
    for j in range(len(log.joints)):
        steps = np.diff(log.q[:, j])
        top = float(np.quantile(np.abs(steps), _TOP))
        if top == 0.0:
            continue
        coarse = _QUANTA * quantum(log.q[:, j])
        for start, end in zip(*runs(steps == 0), strict=True):
            if end - start < least:
                continue
            before = np.abs(steps[max(start - _BEFORE, 0) : start])
            entry = before.min() if len(before) == _BEFORE else 0.0
            jump = abs(steps[end]) if end < len(steps) else 0.0
            if entry > max(_FAST * top, coarse) or jump > max(_JUMP * top, coarse):
                found.append((j, int(start), int(end) + 1))
    return found


def dead_torque_stretches(log: Log) -> list[tuple[int, int, int]]:
    """Joint, first and past-the-last sample of the longest stretch in which a noisy torque stands.

    Not where all torques stand, as of a robot that is switched off, nor at the limit of the channel.
    """
    if log.tau is None or len(log.t) < 4:
        return []
    found = []
    least = max(int(round(_LONG_TORQUE / usual_period(log.t))), 4)
    for j, torque in enumerate(log.tau.T):
        starts, ends = runs(np.diff(torque) == 0)
        lengths = ends - starts
        if len(lengths) == 0 or lengths.max() < least:
            continue
        longest = int(np.argmax(lengths))
        start, end = int(starts[longest]), int(ends[longest]) + 1
        rest = np.delete(torque, slice(start, end))
        if len(rest) <= least:  # it hardly ever does otherwise: what its noise is nobody can tell
            continue
        noise = white_noise(rest[:, None])[0]
        noisy = noise > max(_QUANTUM * quantum(rest), _NOISY * np.ptp(rest))
        usual = np.delete(lengths, longest).max(initial=0) > _ELSEWHERE * lengths[longest]
        others = np.ptp(np.delete(log.tau[start:end], j, axis=1), axis=0) > 0
        inside = torque.min() < torque[start] < torque.max()
        if noisy and not usual and others.any() and inside:
            found.append((j, start, end))
    return found


def without_stuck(log: Log) -> tuple[Log, list[Finding]]:
    """The log without the stretches in which an encoder or a torque's channel stuck, and what was found."""
    stretches = [
        *(("position", *one) for one in stuck_stretches(log)),
        *(("torque", *one) for one in dead_torque_stretches(log)),
    ]
    if not stretches:
        return log, []
    bad = np.zeros(len(log.t), dtype=bool)
    findings: list[Finding] = []
    for _, _, start, end in stretches:
        bad[start:end] = True
    few = bad.mean() <= _MOST_STUCK
    remedy = "That time is left out" if few else "Check the sensor and its wiring, and log it again"
    for channel, j, start, end in stretches:
        what = (
            f"the {channel} of {log.joints[j]} stands from t = {log.t[start]:.6g} to "
            f"{log.t[end - 1]:.6g} s, in the midst of a motion"
        )
        findings.append(Finding(STUCK, what, remedy, refused=not few))
    return (take(log, ~bad) if few else log), findings


def without_saturated(log: Log) -> tuple[Log, list[Finding]]:
    """The log without the samples whose torque sits at its limit, where they are few, and what was found.

    What the motor gave beyond the limit is not in the log; where the drive itself ends there, nothing but the
    samples is lost.
    """
    if log.tau is None:
        return log, []
    bad = np.zeros(len(log.t), dtype=bool)
    told = []
    for j, joint in enumerate(log.joints):
        torque = log.tau[:, j]
        if longest_run(torque == torque.max()) < 2 and longest_run(torque == torque.min()) < 2:
            continue
        at_limit = clipped(torque, _moving(log, j))
        if at_limit.any():
            bad |= at_limit
            told.append(
                f"the torque of {joint} sits at its limit ({torque.min():.4g} or {torque.max():.4g}) "
                f"in {100 * at_limit.mean():.2g} % of the samples"
            )
    few = bad.mean() <= _MOST_SATURATED
    remedy = "They are left out" if few else "Log it with a larger range, or move more gently"
    findings = [Finding(SATURATION, what, remedy, refused=not few) for what in told]
    return (take(log, ~bad) if told and few else log), findings


def _moving(log: Log, joint: int) -> np.ndarray:
    """Whether a joint moves, (T,)."""
    position = log.q[:, joint]
    speed = np.abs(velocity(log.t, position))
    return speed > slowest_motion(log.t, position, speed, quantum(position))
