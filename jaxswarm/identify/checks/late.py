r"""A torque that is late on one joint: no arm does that, a logger that reads its drives in turn does.

What a rough model leaves of a torque that is late by :math:`\theta` is, to first order,
:math:`-\theta\,\dot\tau`. It is asked for on all joints at once; what is common to them is the clock's, which
the model allows for (``time_delay``). Memory of friction looks like a delay as well:
what its bristles carry is taken off before. A reading is as late in one half of the log as in the other, and
at one frequency as at others, which what another law leaves is not.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from jaxswarm.identify.checks.lateness import Lateness
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.rough_fit import STRICTEST
from jaxswarm.identify.checks.sound import UNLESS
from jaxswarm.logs.finding import Finding
from jaxswarm.robot.model import Robot


class _Clear(NamedTuple):
    """What makes a joint's torque clearly late.

    Attributes:
        leaves: Rigid body and friction leave less than this share of it.
        least, most: Time [s] by which it is apart from the others.
        gain: Logarithm of what is left with the delay over without.
        steady: How many of its standard errors the delay is, by what the parts of the log tell.

    Both on logs of many rows; times the strictness of others.
    """

    leaves: float
    least: float
    most: float
    gain: float
    steady: float


# A millisecond or two stand in for friction on clean logs, 60 ms for bristles that bend far. On logs that
# lack any one law the gain is -0.16 at most, on measured arms -0.24 (harmonic drives, 33 to 45 ms). On a
# joint of which little is left nothing else can be taken for a delay: a clearer one (in seconds) needs less
# there. Of 600 joints of 133 logs (clean, lacking a law, measured), no torque of which was late, those that
# seem 12 to 25 ms apart gain up to -0.11, but are no more than 2.6 of their standard errors, on a log of few
# rows 3.7; what is late is 3 to 90 of them.
_RULES = (
    _Clear(np.inf, 0.006, 0.05, -0.28, 0.0),
    _Clear(0.05, 0.010, 0.05, -0.16, 0.0),
    _Clear(0.15, 0.012, 0.025, -0.07, 3.5),
)
# The same in a fine model of a log that has the rows: 95 of 100 torques that are 20 ms late gain 0.2 and more
# there. On 600 joints of 137 logs nothing gains 0.1 and is as steady but a joint whose friction grows with its
# load, 9 ms early by 0.19, and harmonic drives, which look 23 to
# 31 ms late by 0.14 to 0.36 where 3 to 6 % is left. Nothing is steadier than 6.6 errors there but bristles that
# leave 17 %, what is late up to 130.
_FINE_RULES = (
    _Clear(np.inf, 0.006, 0.05, -0.5, 3.5),
    _Clear(0.15, 0.011, 0.021, -0.15, 3.5),
    _Clear(0.025, 0.008, 0.03, -0.12, 3.5),
    _Clear(0.1, 0.006, 0.05, -0.1, 8.0),
)
# Each half of the log tells at least this part of the whole's, to the same side: 0.86 to 1.07 on logs made 20
# ms late on one joint that are clear. One model serves both: with one each, three of ten were missed.
_IN_EACH_HALF = 0.5
_HALVES, _PARTS = 2, 6
# Without the strongest line of what is left of a joint, this part of it is told at least, to the same side:
# what pushes a joint to and fro is answered by its drive, and both look early or late at that one frequency,
# 36 and 37 ms on two worlds, of which without the line 2 are left. Of 34 torques made 20 ms late on clean
# arms and such that lack a law, 0.65 to 1.12 is left, and of 103 others that were told none is lost.
_BESIDE_A_LINE = 0.5
# Nor of what goes by the joint's position, which a stop that it runs into does as sharply as a torque jumps: at
# this part of it, to the same side.
_BESIDE_ITS_PLACE = 0.5
# In motion alone this part of it is told at least, to the same side: while a joint with true stiction is held,
# its drive winds up, which looks early. Of 49 torques made 20 ms late 0.83 to 1.16 is left; of four on joints
# that stick 0.33 to 0.55.
_IN_MOTION = 0.7
# Without the derivative of the joint's friction hardly more is gained than with it: a reading is late in all
# that it reads. Friction that grows with the load leaves what follows the rest of the torque, and looked 22 ms
# early: 1.38 times as much is gained without, in a rough model 1.13 times. Of 341 torques made 20 ms late or
# early, on 22 logs, that were told, it is 0.99 at most, 0.4 usually; on a joint without friction 1.01.
_WITHOUT_FRICTION = 1.05
# By the derivatives of what is fitted this part of it is told at least, to the same side. A torque's own
# derivative has its noise, and a joint of which that is most tells a part of a delay only (W. A. Fuller,
# "Measurement Error Models", 1987, sec. 1.1): of a filter of 30 ms that all torques passed one joint told 8 to
# 12 ms, the other one 29, and was refused; by what is fitted they tell 25 to 29 ms both, 0.15 of that apart. Of
# 46 torques made 20 ms late, on 13 logs, 30 are told before and after, 0.87 to 1.21 of it without noise.
_WITHOUT_NOISE = 0.5
# A fine model tells this part of it at least, where there is one: of play that looked 13 ms early in a rough
# one, by a tenth of what that left, it knows nothing.
_IN_THE_FINE = 0.5
# Less than so many samples apart is a matter of how drives are read: one that holds its torque for a sample is
# read somewhere within it. Three clean logs of another simulator, with 10 and 20 ms a sample, looked 6, 10 and
# 12 ms apart, by 15 % to a half of what was left.
_SAMPLES = 1.0
# A log is refused where a delay takes this part off the squared error that is left of its joint, by one of both
# models: it is more than all else that is missing. What takes less may be a law that looks late, and the log
# goes on: a coupling, a spring and a periodic force took 0.23 to 0.35 of what was left on sound logs of two
# simulators, and are found. Of 94 torques made 20 ms late that were told 93 take 0.51 to 0.99, one 0.35.
_REFUSED = 0.5
# And where it leaves less than this share of the torque, by one of both models: what would remain is no
# arm's then either. An imbalance looked 19 and 22 ms early, and left 0.19 and 0.28 with that as well. Of
# 105 torques made 20 ms late or early, on 42 logs, that were refused, two leave 0.15, all others 0.11 at most.
_LEAVES_REFUSED = 0.17
# A joint counts for this part of the best known one at least, so that all of them count where none tells much.
_LEAST_EVIDENCE = 0.01
# Time [s] that is none.
_NO_TIME = 1e-9


class _Told(NamedTuple):
    """What a model tells of every joint's torque: which is clearly late, by how much [s], and what it gains.

    Beside them the share of the torque that the delay leaves.
    """

    clear: np.ndarray
    apart: np.ndarray
    gain: np.ndarray
    leaves: np.ndarray


def late_torque(robot: Robot, rough: Rough, fine: Rough, interval: float) -> Finding | None:
    """The joint whose torque is clearly late or early against its motion and the other joints' torques.

    A joint alone tells no more than that both clocks are apart, and slow motion hides a delay behind friction:
    then nothing is told. What a part of a sample explains is the clock's.

    Args:
        robot: Its kinematics.
        rough, fine: The log's models.
        interval: The log's sampling interval [s].
    """
    if robot.num_joints < 2:
        return None
    told, finer = _told(rough, _RULES, interval), _told(fine, _FINE_RULES, interval)
    most, leaves = np.minimum(told.gain, finer.gain), np.minimum(told.leaves, finer.leaves)
    if fine.strictness < STRICTEST:
        agreed = finer.apart * np.sign(told.apart) >= _IN_THE_FINE * np.abs(told.apart)
        told = told._replace(clear=told.clear & agreed)
        told = told if told.clear.any() else finer
    if not told.clear.any():
        return None
    j = int(np.argmin(np.where(told.clear, told.gain, 0.0)))
    share = 100.0 * (1.0 - np.exp(told.gain[j]))
    what = (
        f"the torque of {robot.joints[j]} is {1e3 * abs(told.apart[j]):.0f} ms "
        f"{'late' if told.apart[j] > 0 else 'early'} against the other joints, which is {share:.0f} % of what "
        "rigid body and friction leave of it"
    )
    if np.exp(2.0 * most[j]) < 1.0 - _REFUSED and leaves[j] < _LEAVES_REFUSED:
        return Finding("late_torque", what, "Shift this column of the log")
    what += UNLESS
    return Finding(
        "late_torque", what, "If no effect explains it, shift this column", refused=False
    )


def _told(model: Rough, rules: Sequence[_Clear], interval: float) -> _Told:
    """Which joints are late by one of some rules."""
    logged, sigma = model.as_logged()
    found = model.lateness(sigma)
    apart = _apart(found)
    gain = _beyond_common(found.gain, found.seconds, apart)
    agreed, steady = _in_each_half(model, sigma, apart), _steadiness(model, sigma, apart)
    clear = np.zeros(len(apart), bool)
    for rule in rules:
        least = max(rule.least, _SAMPLES * interval)
        beyond = (np.abs(apart) > least) & (np.abs(apart) < rule.most)
        gained = (gain < rule.gain * model.strictness) & (steady >= rule.steady * model.strictness)
        clear |= agreed & beyond & gained & (logged.left < rule.leaves)
    for j in map(int, np.flatnonzero(clear)):
        clear[j] = _apart_beside_a_line(model, sigma, j) / apart[j] >= _BESIDE_A_LINE
    for j in map(int, np.flatnonzero(clear)):
        clear[j] = _apart_beside_its_place(model, sigma, j) / apart[j] >= _BESIDE_ITS_PLACE
    if clear.any():
        # Without the slow rows of the others too: one that moves was told as late against three that stick.
        in_motion = _apart(model.lateness_in_motion(sigma))
        clear[clear] = in_motion[clear] / apart[clear] >= _IN_MOTION
    if clear.any():
        by_fitted = _apart(model.lateness_without_noise(sigma))
        clear[clear] = by_fitted[clear] / apart[clear] >= _WITHOUT_NOISE
    for j in map(int, np.flatnonzero(clear)):
        clear[j] = _left_without_friction(model, sigma, j, found) < _WITHOUT_FRICTION
    return _Told(clear, apart, gain, logged.left * np.exp(gain))


def _apart(found: Lateness) -> np.ndarray:
    """By how much every joint is late against the others [s], (n,): against what half of their evidence says.

    Of a joint whose error hardly changes with a delay nothing is known: on a world whose torques were all late,
    one such, 40 ms early, made the one that told it best late against "the others".
    """
    told = np.square(found.seconds)
    taken = np.maximum(-np.expm1(2.0 * found.gain), 0.0)  # a joint may pay for what the others gain
    evidence = np.divide(taken, told, out=np.zeros_like(told), where=told > 0)
    evidence = np.maximum(evidence, _LEAST_EVIDENCE * evidence.max() + 1e-300)
    order = np.argsort(found.seconds)
    apart = np.empty_like(told)
    for j, seconds in enumerate(found.seconds):
        others = order[order != j]
        below = np.cumsum(evidence[others])
        apart[j] = seconds - found.seconds[others[np.searchsorted(below, 0.5 * below[-1])]]
    return apart


def _apart_beside_a_line(model: Rough, sigma: np.ndarray, joint: int) -> float:
    """By how much a joint is late against the others [s], where its strongest line is not asked."""
    return float(_apart(model.lateness_beside_a_line(sigma, joint))[joint])


def _apart_beside_its_place(model: Rough, sigma: np.ndarray, joint: int) -> float:
    """By how much a joint is late against the others [s], where what goes by its position is not asked."""
    return float(_apart(model.lateness_beside_its_place(sigma, joint))[joint])


def _left_without_friction(model: Rough, sigma: np.ndarray, joint: int, found: Lateness) -> float:
    """Part of what a joint gains by its delay that is gained where its friction is none."""
    return float(model.lateness_without_friction(sigma, joint).gain[joint] / found.gain[joint])


def _in_each_half(rough: Rough, sigma: np.ndarray, apart: np.ndarray) -> np.ndarray:
    """Whether both halves of the log tell of each joint what the whole does, (n,)."""
    halves = np.array([_apart(half) for half in rough.lateness_in_parts(sigma, _HALVES)])
    return np.all(halves * np.sign(apart) >= _IN_EACH_HALF * np.abs(apart), axis=0)


def _steadiness(rough: Rough, sigma: np.ndarray, apart: np.ndarray) -> np.ndarray:
    """How many standard errors every joint's time is, by how much the parts of the log differ, (n,)."""
    parts = np.array([_apart(part) for part in rough.lateness_in_parts(sigma, _PARTS)])
    error = parts.std(axis=0, ddof=1) / np.sqrt(_PARTS)
    return np.abs(apart) / np.maximum(error, _NO_TIME)


def _beyond_common(gain: np.ndarray, seconds: np.ndarray, apart: np.ndarray) -> np.ndarray:
    """Logarithm of what is left with the delay over what is left with that of the other joints, (n,).

    What a delay leaves grows with its square, so that a joint's own part of it says by how much. A delay of all
    drives that one joint tells a few milliseconds short is a matter of the clock.
    """
    left = np.exp(gain)
    part = np.square(np.divide(apart, seconds, out=np.zeros_like(apart), where=seconds != 0.0))
    return np.log(left / (left + (1.0 - left) * np.minimum(part, 1.0)))
