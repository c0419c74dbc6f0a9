"""The torque that a link behind its motor changes, for many values of its parameters at once."""

import numpy as np

from jaxswarm.diagnose.candidates.swings import swings
from jaxswarm.diagnose.candidates.thinned import thinned, usual_inertia
from jaxswarm.effects.deflection import substeps_of
from jaxswarm.effects.kinds import MeasurementLaw, TransmissionLaw
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.identify.forward.sensitivity import BLOCK, Sensitivity
from jaxswarm.identify.forward.written_down import report, report_own
from jaxswarm.logs.motion import Motion

# Shares of a joint's inertia that its rotor may hold.
ROTOR_SHARES = np.linspace(0.0, 0.9, 7)
# Numbers that a torque of all options may hold: of a long log some options pass at a time. A link's swing and
# its derivatives are as many as the torques of so many joints.
MOST_NUMBERS, _SWINGS = 2**24, 4
# Times as many options share the columns of a long log as swing at a time: 22 gaps of a million samples, of
# which what their joint feels is 0.7 GB.
_TOGETHER = 6

# Stiffness, damping, dead zone and hardening of options, each (m,).
Gears = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def lag_torque(
    motion: Motion,
    sensed: Sensitivity,
    pis: np.ndarray,
    k: np.ndarray,
    d: np.ndarray,
    gap: np.ndarray,
    hard: np.ndarray,
    longer: float = 2.0,
    terms: tuple[Term, ...] = (),
    own: bool = False,
) -> np.ndarray:
    """Decimated torque (m, T', n) that a lagging link changes, for m options with their parameters.

    Args:
        motion: The log.
        sensed: What the rigid torque does when the joint moves otherwise.
        pis: Rigid parameters, (m, 10 n); one row serves all options.
        k, d, gap, hard: Stiffness, damping, dead zone and hardening, each (m,).
        longer: How many times longer the steps of the integrator may be than a fit's.
        terms: The model's, whose drives report the torque.
        own: Whether the torque of the joint itself is enough: (m, T', 1).
    """
    motion, sensed = thinned(motion, sensed)
    (count, joints), substeps = motion.q.shape, substeps_of(1.0 / motion.rate, longer)
    swung = max(1, MOST_NUMBERS // (count * _SWINGS))
    at_once = max(1, MOST_NUMBERS // (count * max(_SWINGS, 1 if own else joints)))
    # Where many options share columns these are made twice for all, not once for every few.
    shared = len(pis) > 2 * at_once and not own and not of_kind(terms, MeasurementLaw)
    size = _TOGETHER * swung if shared else at_once
    found = np.empty(0)
    for start in range(0, len(k), size):
        some = slice(start, start + size)
        by, gear = pis if len(pis) == 1 else pis[some], (k[some], d[some], gap[some], hard[some])
        if shared:
            part = _changed_in_parts(motion, sensed, by, gear, substeps, swung)
        else:
            part = _changed(motion, sensed, by, gear, substeps, at_once, terms, own)
        if len(part) == len(k):
            return part
        if not start:
            found = np.empty((len(k), *part.shape[1:]))
        found[some] = part
    return found


def _acted_on(sensed: Sensitivity, own: bool) -> slice:
    """The joints whose torque is asked for."""
    return slice(sensed.joint, sensed.joint + 1) if own else slice(None)


def _changed(
    motion: Motion,
    sensed: Sensitivity,
    pis: np.ndarray,
    gear: Gears,
    substeps: int,
    most: int,
    terms: tuple[Term, ...],
    own: bool,
) -> np.ndarray:
    """The torque of :func:`lag_torque` for options that stand in memory together, (m, T', n or 1)."""
    moving, felt = sensed.joint, sensed.at(pis, _acted_on(sensed, own))
    joint = 0 if own else moving
    lags = swings(motion, [x[:, joint] for x in felt], gear, substeps, most)
    change = _by_lags(felt[1:], lags)
    told = report_own(terms, motion, change[:, 0], moving) if own else change
    told = told[:, None] if own else report(terms, motion, told)
    return -np.moveaxis(motion.decimator.apply(told), 2, 0)


def _changed_in_parts(
    motion: Motion, sensed: Sensitivity, pis: np.ndarray, gear: Gears, substeps: int, most: int
) -> np.ndarray:
    """The same of options with parameters of their own, of drives that report a torque as it is, (m, T', n).

    Columns of a long log are made anew for every part of it: once for what the joint feels of all options, and
    once for what their lags do to the torque. Nothing but what the joint feels is held.
    """
    felt = [x[:, 0] for x in sensed.at(pis, _acted_on(sensed, True))]
    each = -(-len(pis) // -(-len(pis) // most))  # alike, so that none is filled up
    for start in range(0, len(pis), each):
        some = slice(start, start + each)
        lags = swings(motion, [x[:, some] for x in felt], [x[some] for x in gear], substeps, each)
        for x, lag in zip(felt[1:], np.moveaxis(lags, 1, 0), strict=True):
            x[:, some] = lag  # what was felt there is not asked for again
    low, row = motion.decimator, 0
    found = np.empty((len(pis), len(low.kept(len(motion.t))), motion.q.shape[1]))
    for part in low.blocks(len(motion.t), BLOCK):
        slopes = sensed.during(part, pis)[1:]
        change = low.apply(_by_lags(slopes, np.stack([x[part] for x in felt[1:]], axis=1)))
        found[:, row : row + len(change)] = -np.moveaxis(change, 2, 0)
        row += len(change)
    return found


def _by_lags(slopes: tuple[np.ndarray, ...], lags: np.ndarray) -> np.ndarray:
    """What lags (T, 3, m) change of torques, (T, n, m), by their derivatives (T, n, 1 or m)."""
    by_q, by_dq, by_ddq = slopes
    if by_q.shape[2] == 1:
        # One small product a sample: the numbers pass through memory once, not five times.
        return np.concatenate(slopes, axis=2) @ lags
    change = lags[:, :1] * by_q
    change += lags[:, 1:2] * by_dq
    change += lags[:, 2:] * by_ddq
    return change


def gears(law: TransmissionLaw, options: list[dict], sensed: Sensitivity, pi: np.ndarray) -> Gears:
    """What makes gears of options (m,) with the link's inertia on a log, as the fit has them."""
    # A gear is as stiff as the median inertia asks for: taken once, not for every option.
    inertia = np.array([usual_inertia(sensed, pi)])
    found = [law.gear(option, inertia) for option in options]
    k, d, gap, hard = (np.array([float(x) for x in own]) for own in zip(*found, strict=True))
    return k, d, gap, hard
