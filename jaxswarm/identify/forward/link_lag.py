r"""The motion of links that lag behind their motors, and what it takes from the rigid parameters.

The lag e of a flexible joint, or of one with backlash, follows the rigid torque
(:mod:`jaxswarm.effects.deflection`), so the torque
is no longer linear in the rigid parameters :math:`\pi`: near resonance the lag decides the fit that decides
the lag. :func:`lag_slopes` gives the missing part of the derivative,
:math:`-(\tau_q\,\partial e + \tau_{\dot q}\,\partial\dot e + \tau_{\ddot q}\,\partial\ddot e)/\partial\pi`.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import jax
import numpy as np
import scipy

from jaxswarm.effects.deflection import deflection, substeps_of
from jaxswarm.effects.kinds import MeasurementLaw, TransmissionLaw
from jaxswarm.effects.misreading import misreading
from jaxswarm.effects.term import Term, of_kind, valued
from jaxswarm.identify.forward.columns import Moved, Rigid, is_kept
from jaxswarm.identify.forward.latest import last_of
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.identify.forward.metrics import is_moving
from jaxswarm.identify.forward.sensitivity import sensitivity_of
from jaxswarm.logs.motion import Motion
from jaxswarm.programs import program
from jaxswarm.robot.model import Robot

# A log that begins at rest does not move in its first moments [s].
_EARLY = 0.25
# How long a link that no one saw begin to swing is left out [s], and the most of a log. A gear at 3.7 Hz with a
# damping ratio of 0.04 (q10 of the practice logs), begun out of balance, swung by 20 N m: fitted from the first
# sample on it found no name, without two seconds k = 1068 N m/rad, 95 % [1060, 1076], where 1066 is true.
_SWINGING, _SHARE = 2.0, 0.1


def unseen_start(motion: Motion) -> float:
    """Time [s] from the start of a log in which a link on a spring may still swing by what was before it.

    A log that begins at rest begins in equilibrium. One that begins in motion may begin in the middle of a
    swing, of which neither the twist nor its rate was measured.
    """
    since = motion.t - motion.t[0]
    if not is_moving(motion.dq)[since < _EARLY].any():
        return 0.0
    return min(_SWINGING, _SHARE * float(since[-1]))


def calm_start(motion: Motion) -> np.int32:
    """Samples at the start of a log in which a link on a spring settles, as its swing was not seen to begin."""
    return np.int32(round(unseen_start(motion) * motion.rate))


def unseen_samples(motion: Motion) -> np.ndarray:
    """The samples of a log (T,) in which a link may still swing by what was before it."""
    return motion.t - motion.t[0] < unseen_start(motion)


def unseen_rows(motion: Motion) -> np.ndarray:
    """The rows of a regression (T',) in which a link may still swing by what was before the log."""
    return unseen_samples(motion)[motion.decimator.kept(len(motion.t))]


def term_deflection(term: Term, motion: Motion, sensed: tuple) -> tuple[np.ndarray, ...]:
    """Lag of a link along a log: e, de, dde, each (T,); ``sensed``: of its joint alone, (T, 1) each."""
    torque, by_q, by_dq, by_ddq = (x[:, 0] for x in sensed)
    driven = filled((by_ddq, by_dq, by_q, torque))
    step = 1.0 / motion.rate
    clock = step, calm_start(motion), substeps_of(step)
    lag = deflection(*driven, *_transmission(term, by_ddq), *clock)
    lag = (np.asarray(x)[: len(motion.t)] for x in lag)
    size = max(1, round(blur_of(term) * motion.rate))
    return tuple(scipy.ndimage.uniform_filter1d(x, size, mode="nearest") for x in lag)


def blur_of(term: Term) -> float:
    """Time [s] over which a lag is averaged: by how much an impact may be off; zero without backlash."""
    return _values(term).get("blur", 0.0)


def _values(term: Term) -> dict[str, float]:
    """Parameters of a term, nominal where it has no values."""
    return {**term.law.nominal(), **term.values}


def slope_terms(terms: tuple[Term, ...]) -> list[Term]:
    """The transmissions whose lag follows the rigid parameters smoothly enough for a derivative."""
    return [t for t in of_kind(terms, TransmissionLaw) if blur_of(t) == 0.0]


def flank_compression(
    robot: Robot, term: Term, motion: Motion, pi: np.ndarray, rigid: Rigid | None = None
) -> float:
    """How far a gear with backlash is pressed together on its flanks [rad], the median along a log.

    Where a flank begins is not known more closely: gap and compression add up. Zero for other terms.
    """
    if not isinstance(term.law, TransmissionLaw) or term.law.gap is None:
        return 0.0
    torque, _, _, inertia = (
        x[:, term.index] for x in sensitivity_of(robot, motion, term.index, rigid).at(pi)
    )
    return float(np.median(np.abs(torque)) / _transmission(term, inertia)[0])


def _transmission(term: Term, inertia: np.ndarray) -> tuple[jax.Array, ...]:
    """Stiffness, damping, gap and hardening of a joint whose link has this inertia (T,)."""
    values = {n: np.float64(x) for n, x in _values(term).items()}
    return term.law_of(TransmissionLaw).gear(values, np.asarray(inertia))


def link_motion(
    robot: Robot,
    terms: tuple[Term, ...],
    motion: Motion,
    pi: np.ndarray,
    rigid: Rigid | None = None,
) -> Moved:
    """Motion (q, dq, ddq) of the links where some lag behind their motors."""
    q, dq, ddq = motion.q.copy(), motion.dq.copy(), motion.ddq.copy()
    for term in of_kind(terms, TransmissionLaw):
        own = slice(term.index, term.index + 1)
        sensed = sensitivity_of(robot, motion, term.index, rigid).at(pi, own)
        lag = term_deflection(term, motion, sensed)
        for x, e in zip((q, dq, ddq), lag, strict=True):
            x[:, term.joint] -= np.asarray(e)
    return q, dq, ddq


def as_read(
    terms: tuple[Term, ...], motion: Motion, rigid: Rigid | None
) -> tuple[Motion, Rigid | None]:
    """A log as its encoders should have said it, and what is known of columns there.

    A fit asks for dozens of widths by the same errors: beside a wrist of which one joint turns another and a
    dead zone of a third joint, one took 127 s, and two thirds of that made the same columns.
    """
    wrong = _misread(terms)
    if not wrong:
        return motion, rigid
    if rigid is None or motion.q is not rigid.motion.q or not is_kept(motion):
        return true_motion(terms, motion), None
    robot = rigid.robot
    known = last_of(rigid.read, valued(wrong), lambda: Rigid(robot, true_motion(terms, motion)))
    true = known.motion
    return replace(motion, q=true.q, dq=true.dq, ddq=true.ddq), known


def _misread(terms: tuple[Term, ...]) -> list[Term]:
    return [t for t in of_kind(terms, MeasurementLaw) if t.law.excess is not None]


def true_motion(terms: tuple[Term, ...], motion: Motion) -> Motion:
    """A log with what its encoders say too much taken off: links, friction and rotors follow that."""
    wrong = _misread(terms)
    if not wrong:
        return motion
    q, dq, ddq = motion.q.copy(), motion.dq.copy(), motion.ddq.copy()
    for term in wrong:
        for x, e in zip((q, dq, ddq), excess_of(term, motion, _values(term)), strict=True):
            x[:, term.joint] -= e
    return replace(motion, q=q, dq=dq, ddq=ddq)


def excess_of(term: Term, motion: Motion, values: Mapping) -> tuple[np.ndarray, ...]:
    """What an encoder says too much along a log, and its two derivatives, each (T,)."""
    along = misreading(term.law, dict(values), filled(read_motion(term, motion)))
    return tuple(np.asarray(e)[: len(motion.t)] for e in along)


def read_motion(term: Term, motion: Motion) -> tuple[np.ndarray, ...]:
    """q, dq, ddq (T, 2) of what an encoder's error follows: its joint, and its partner or the joint again."""
    places = [term.index, term.index if term.other is None else term.other]
    return tuple(x[:, places] for x in (motion.q, motion.dq, motion.ddq))


def lag_slopes(
    robot: Robot,
    terms: tuple[Term, ...],
    motion: Motion,
    pi: np.ndarray,
    rigid: Rigid | None = None,
) -> np.ndarray:
    """Derivative of the torque by the rigid parameters that runs through the lag of links.

    To first order about the motors' motion, shape (T, n, 10 (n - j)): of the links from the first joint j on
    that has a lag. Those before it are not felt there.
    """
    lagging = slope_terms(terms)
    first = 10 * min(term.index for term in lagging)
    total = np.zeros((*motion.q.shape, len(pi) - first))
    for term in lagging:
        j = term.index
        sensed = sensitivity_of(robot, motion, j, rigid)
        own = sensed.own()
        felt = np.flatnonzero(np.abs(own).max(axis=(0, 1)) > 0)
        clock, by = (1.0 / motion.rate, calm_start(motion)), own @ pi[10 * j :]
        steps = substeps_of(clock[0])
        lags = _lag_directions(term.law, by, own[:, :, felt], _values(term), clock, steps)
        slopes = sensed.slopes(pi)
        for k in range(total.shape[1]):
            total[:, k, 10 * j - first + felt] -= sum(
                by[:, k, None] * np.asarray(lag) for by, lag in zip(slopes, lags, strict=True)
            )
    return total


@program("law", "substeps")
def _lag_directions(law, own, directions, values, clock, substeps):
    """Derivatives (T, m) of e, de, dde along m directions (4, T, m) of torque and sensitivities."""

    def lag(signals):
        torque, by_q, by_dq, by_ddq = signals
        return deflection(by_ddq, by_dq, by_q, torque, *law.gear(values, by_ddq), *clock, substeps)

    along = partial(jax.jvp, lag, (own,))
    return jax.vmap(lambda x: along((x,))[1], in_axes=2, out_axes=1)(directions)
