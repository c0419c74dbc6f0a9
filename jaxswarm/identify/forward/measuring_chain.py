r"""All columns of a model: what the rigid body really did, on which clock, on which scale.

The order in which a torque comes about fixes the order here: the links move behind their motors
(:class:`TransmissionLaw`) in a gravity (:class:`BodyChange`), motors and surroundings add their torques
(:class:`TorqueLaw`, :class:`ExternalTorque`), and the drives write them down (:class:`MeasurementLaw`).
"""

from collections.abc import Sequence
from functools import singledispatch
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.base import Effect
from jaxswarm.effects.distortion import distortion_columns
from jaxswarm.effects.kinds import (
    BodyChange,
    ExternalTorque,
    MeasurementLaw,
    TorqueLaw,
    TransmissionLaw,
)
from jaxswarm.effects.measurement import shift
from jaxswarm.effects.sample import Sample
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.identify.forward.columns import Load, Rigid, load_of, rigid_columns, term_columns
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.identify.forward.link_lag import link_motion
from jaxswarm.identify.forward.placement import placement_columns
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot


def tilted(robot: Robot, terms: tuple[Term, ...]) -> Robot:
    """The robot in the gravity its terms say."""
    for term in of_kind(terms, BodyChange):
        if term.law.gravity is not None:
            gravity = term.law.gravity(term.values, jnp.asarray(robot.gravity))
            robot = robot.replace(gravity=gravity)
    return robot


def uses_load(terms: tuple[Term, ...]) -> bool:
    """Whether a term's columns depend on the rigid torque."""
    return any(t.law.uses_load for t in terms)


def moves_links(terms: tuple[Term, ...]) -> bool:
    """Whether a term changes the rigid columns themselves."""
    return any(t.law.changes_rigid_columns for t in terms)


class _Body(NamedTuple):
    """A rigid body on its way: the arm in its gravity, motion of the links, parameters and their columns."""

    arm: Robot
    moved: tuple[np.ndarray, ...]
    pi: np.ndarray
    columns: np.ndarray


def assemble(
    robot: Robot,
    terms: tuple[Term, ...],
    motion: Motion,
    width: Sequence[float],
    pi: np.ndarray,
    rigid: Rigid | None = None,
    decimate: bool = False,
    log: int | None = None,
) -> np.ndarray:
    """Columns of a log for given nonlinear and rigid parameters, shape (T, n, p).

    Args:
        robot: Kinematics and nominal gravity.
        terms: With values of their nonlinear parameters.
        motion: The log.
        width: Width of the smooth sign.
        pi: Rigid parameters (10 n,) that load-dependent terms and transmissions go by.
        rigid: Rigid columns of the plain motion in nominal gravity, where known.
        decimate: Whether to return the columns through the decimator, (T', n, p).
        log: Number of the log: columns of what happened in another one are zero; None: all happened here.

    Returns:
        Standard parameters first, then the linear parameters of the terms in their order.
    """
    low = motion.decimator.apply if decimate else np.asarray
    measured = of_kind(terms, MeasurementLaw)
    if moves_links(terms) or rigid is None:
        arm, kept = tilted(robot, terms), None
        moved = link_motion(arm, terms, motion, pi, rigid)
        full = rigid_columns(arm, *moved)
        static = None
    else:
        arm, moved = robot, (motion.q, motion.dq, motion.ddq)
        full, static = rigid.full, rigid.static
        kept = rigid.low if decimate and not measured else None
    load = None
    if uses_load(terms):
        if static is None:
            static = rigid_columns(arm, moved[0], moved[1], np.zeros_like(moved[2]))
        load = load_of(full, static, pi)
    body = _Body(arm, moved, pi, full)
    if any(t.law.distortion for t in measured):
        load = load._replace(whole=_whole_torque(terms, motion, width, load, body))

    parts = [kept if kept is not None else low(full)]
    if measured:
        parts = [low(report(terms, motion, full))]
    for term in terms:
        if term.columns(robot.joints):
            block = _supplied(term, motion, width, load, body)
            here = log is None or not term.law.in_one_log or term.values.get("log", 0) == log
            parts.append(low(report(terms, motion, block if here else 0.0 * block)))
    return np.concatenate(parts, axis=2)


def _whole_torque(
    terms: tuple[Term, ...],
    motion: Motion,
    width: Sequence[float],
    load: Load,
    body: _Body,
) -> np.ndarray:
    """Torque (T, n) that drives distort: of the rigid body and of all terms by the values they have."""
    whole = load.full.copy()
    for term in terms:
        if not (isinstance(term.law, MeasurementLaw) and term.law.distortion):
            names = term.linear_names(motion.joints)
            values = np.array([term.values.get(name, 0.0) for name in names])
            whole += _supplied(term, motion, width, load, body) @ values
    return whole


def _supplied(
    term: Term, motion: Motion, width: Sequence[float], load: Load | None, body: _Body
) -> np.ndarray:
    """Columns (T, n, k) of a term on the working clock, with those that follow from the rigid body."""
    law = term.law
    if isinstance(law, BodyChange) and law.placement is not None:
        return placement_columns(law, term.joint, body.arm, body.moved, body.pi)
    if isinstance(law, BodyChange) and law.window:
        weight = np.asarray(law.weight(term.values, motion.t))
        return weight[:, None, None] * (body.columns[:, :, -10:] @ body_basis(law))
    return own_columns(term, motion, width, load)


def body_basis(law: BodyChange) -> np.ndarray:
    """Inertial parameters of the last link by each parameter of a body, (10, 10)."""
    names = law.candidate_names(())
    unit = [{name: float(name == one) for name in names} for one in names]
    return np.stack([np.asarray(law.body(p)) for p in unit], axis=1)


def own_columns(
    term: Term, motion: Motion, width: Sequence[float], load: Load | None
) -> np.ndarray:
    """Columns of a term on the working clock, (T, n, k), zero on joints it does not act on."""
    return law_block(term.law, term, motion, width, load)


@singledispatch
def law_block(
    law: Effect, term: Term, motion: Motion, width: Sequence[float], load: Load | None
) -> np.ndarray:
    """Columns (T, n, k) that a term adds by itself."""
    raise NotImplementedError(f"no columns for effects of kind {type(law).__name__}")


@law_block.register(TransmissionLaw)
@law_block.register(BodyChange)
def _(law, term, motion, width, load):
    return np.zeros((*motion.q.shape, 0))  # they change the columns of others


@law_block.register
def _(law: MeasurementLaw, term, motion, width, load):
    block = np.zeros((*motion.q.shape, len(law.linear)))
    if law.distortion is not None:
        block[:, term.joint] = distortion_columns(law, load.whole[:, term.joint])
    return block


@law_block.register
def _(law: TorqueLaw, term, motion, width, load):
    own = term_columns(term, motion, width, load)
    block = np.zeros((len(own), motion.q.shape[1], own.shape[1]))
    block[:, term.joint] = own
    return block


@law_block.register
def _(law: ExternalTorque, term, motion, width, load):
    return law.weight(term.values, motion.t)[:, None, None] * np.eye(motion.q.shape[1])


def report(terms: tuple[Term, ...], motion: Motion, block: np.ndarray) -> np.ndarray:
    """Torques (T, n, ...) as they are written down: by the drive of each joint, then by their clock."""
    measured = of_kind(terms, MeasurementLaw)
    size, block = len(block), filled(block) if measured else block
    for term in sorted(measured, key=lambda t: t.joint is None):
        own = (slice(None), slice(None) if term.joint is None else term.joint)
        block[own] = term.law.report(term.values, block[own], 1.0 / motion.rate)
    return block[:size]


def report_own(terms: tuple[Term, ...], motion: Motion, own: np.ndarray, joint: int) -> np.ndarray:
    """Columns (T, k) that act on one joint as its drive reports them."""
    if not of_kind(terms, MeasurementLaw):
        return own
    block = np.zeros((len(own), motion.q.shape[1], own.shape[1]))
    block[:, joint] = own
    return report(terms, motion, block)[:, joint]


def lateness(terms: tuple[Term, ...]) -> float:
    """Time [s] by which the terms say the clock of the torque lags."""
    return sum(t.law.lateness(t.values) for t in of_kind(terms, MeasurementLaw))


def late(series: Sample, seconds: float, motion: Motion) -> Sample:
    """What a law sees, so much later: its torque is then what a late clock reports of it."""
    if not seconds:
        return series
    held = filled(series)
    later = (np.asarray(_shift(x, seconds, 1.0 / motion.rate)) for x in held)
    return Sample(*(x[: len(motion.t)] for x in later))


def term_block(
    robot: Robot,
    terms: tuple[Term, ...],
    term: Term,
    motion: Motion,
    width: Sequence[float],
    pi: np.ndarray,
    rigid: Rigid,
) -> np.ndarray:
    """Decimated columns of one term of a model, (T', n, k); links are taken as stiff for its load."""
    load = load_of(rigid.full, rigid.static, pi) if term.law.uses_load else None
    return motion.decimator.apply(report(terms, motion, own_columns(term, motion, width, load)))


_shift = jax.jit(shift)
