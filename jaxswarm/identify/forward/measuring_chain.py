r"""All columns of a model: what the rigid body really did, on which clock, on which scale.

The order in which a torque comes about fixes the order here: the links move behind their motors
(:class:`TransmissionLaw`) in a gravity (:class:`BodyChange`), motors and surroundings add their torques
(:class:`TorqueLaw`, :class:`ExternalTorque`), and the drives write them down (:class:`MeasurementLaw`).
"""

from collections.abc import Callable, Sequence
from functools import partial, singledispatch

import jax
import numpy as np

from jaxswarm.effects.base import Effect
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
from jaxswarm.identify.forward.columns import (
    Load,
    Rigid,
    load_along,
    low_columns,
    rigid_columns,
    term_columns,
)
from jaxswarm.identify.forward.link_lag import link_motion
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot


def tilted(robot: Robot, terms: tuple[Term, ...]) -> Robot:
    """The robot in the gravity its terms say."""
    for term in of_kind(terms, BodyChange):
        if term.law.gravity is not None:
            values = {name: np.float64(value) for name, value in term.values.items()}
            robot = robot.replace(gravity=_gravity(term.law, values, robot.gravity))
    return robot


@partial(jax.jit, static_argnames="law")
def _gravity(law: BodyChange, values: dict, gravity: jax.Array) -> jax.Array:
    return law.gravity(values, gravity)


def uses_load(terms: tuple[Term, ...]) -> bool:
    """Whether a term's columns depend on the rigid torque."""
    return any(t.law.uses_load for t in terms)


def moves_links(terms: tuple[Term, ...]) -> bool:
    """Whether a term changes the rigid columns themselves."""
    return any(t.law.changes_rigid_columns for t in terms)


def assemble(
    robot: Robot,
    terms: tuple[Term, ...],
    motion: Motion,
    width: Sequence[float],
    pi: np.ndarray,
    rigid: Rigid | None = None,
    decimate: bool = False,
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

    Returns:
        Standard parameters first, then the linear parameters of the terms in their order.
    """
    low = motion.decimator.apply if decimate else np.asarray
    measured = of_kind(terms, MeasurementLaw)
    load = None
    if moves_links(terms) or rigid is None:
        arm = tilted(robot, terms)
        moved = link_motion(arm, terms, motion, pi, rigid)
        if decimate and not measured:
            parts = [low_columns(arm, *moved, motion.decimator)]
        else:
            parts = [low(report(terms, motion, rigid_columns(arm, *moved)))]
        if uses_load(terms):
            load = load_along(arm, moved, pi)
    else:
        kept = decimate and not measured
        parts = [rigid.low if kept else low(report(terms, motion, rigid.full))]
        if uses_load(terms):
            load = rigid.load(pi)
    for term in terms:
        if term.columns(robot.joints):
            parts.append(_block(terms, term, motion, width, load, low))
    return np.concatenate(parts, axis=2)


def _block(
    terms: tuple[Term, ...],
    term: Term,
    motion: Motion,
    width: Sequence[float],
    load: Load | None,
    low: Callable[[np.ndarray], np.ndarray],
) -> np.ndarray:
    """Columns of a term of a model as reported, through ``low``: (T', n, k)."""
    if not isinstance(term.law, TorqueLaw):
        return low(report(terms, motion, own_columns(term, motion, width, load)))
    own = low(report_own(terms, motion, term_columns(term, motion, width, load), term.joint))
    return placed(own, term.joint, motion.q.shape[1])


def placed(own: np.ndarray, joint: int, joints: int) -> np.ndarray:
    """Columns (T, k) of one joint as those of all, (T, n, k)."""
    block = np.zeros((len(own), joints, own.shape[1]))
    block[:, joint] = own
    return block


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
@law_block.register(MeasurementLaw)
def _(law, term, motion, width, load):
    return np.zeros((*motion.q.shape, 0))  # they change the columns of others


@law_block.register
def _(law: TorqueLaw, term, motion, width, load):
    return placed(term_columns(term, motion, width, load), term.joint, motion.q.shape[1])


@law_block.register
def _(law: ExternalTorque, term, motion, width, load):
    return law.weight(term.values, motion.t)[:, None, None] * np.eye(motion.q.shape[1])


def report(terms: tuple[Term, ...], motion: Motion, block: np.ndarray) -> np.ndarray:
    """Torques (T, n, ...) as they are written down: by the drive of each joint, then by their clock."""
    measured = of_kind(terms, MeasurementLaw)
    for term in sorted(measured, key=lambda t: t.joint is None):
        own = (slice(None), slice(None) if term.joint is None else term.joint)
        block = block.copy()
        block[own] = term.law.report(term.values, block[own], 1.0 / motion.rate)
    return block


def report_own(terms: tuple[Term, ...], motion: Motion, own: np.ndarray, joint: int) -> np.ndarray:
    """Columns (T, k) that act on one joint as its drive reports them."""
    if not of_kind(terms, MeasurementLaw):
        return own
    return report(terms, motion, placed(own, joint, motion.q.shape[1]))[:, joint]


def lateness(terms: tuple[Term, ...]) -> float:
    """Time [s] by which the terms say the clock of the torque lags."""
    clocks = [t for t in of_kind(terms, MeasurementLaw) if t.law.clock]
    return sum(t.values[t.law.parameters[0].name] for t in clocks)


def late(series: Sample, seconds: float, motion: Motion) -> Sample:
    """What a law sees, so much later: its torque is then what a late clock reports of it."""
    if not seconds:
        return series
    return Sample(*(np.asarray(_shift(x, seconds, 1.0 / motion.rate)) for x in series))


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
    load = rigid.load(pi) if term.law.uses_load else None
    return _block(terms, term, motion, width, load, motion.decimator.apply)


_shift = jax.jit(shift)
