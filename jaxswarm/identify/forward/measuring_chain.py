r"""All columns of a model with its warps: what the rigid body really did, on which clock, on which scale.

The order in which a torque comes about fixes the order here: the links move (``joint_elasticity``,
``backlash``) in a gravity (``base_tilt``), the motors add their laws, the drive scales what it reports
(``drive_gain``) and the log's clock may lag (``time_delay``).
"""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.base import Sample
from jaxswarm.effects.term import Term, warped
from jaxswarm.effects.warps import LAGGING, shift
from jaxswarm.identify.forward.columns import Load, Rigid, load_of, rigid_columns, term_columns
from jaxswarm.identify.forward.link_lag import link_motion
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot


def tilted(robot: Robot, terms: tuple[Term, ...]) -> Robot:
    """The robot in the gravity its ``base_tilt`` term says; the magnitude is kept."""
    robot_gravity = np.asarray(robot.gravity)
    for term in warped(terms, "gravity"):
        size = np.linalg.norm(robot_gravity)
        xy = np.array([term.values["gx"], term.values["gy"]])
        down = np.sign(robot_gravity[2]) * np.sqrt(max(size**2 - xy @ xy, 0.0))
        robot = robot.replace(gravity=jnp.array([*xy, down]))
    return robot


def uses_load(terms: tuple[Term, ...]) -> bool:
    """Whether a term's columns depend on the rigid torque."""
    return any(t.law.uses_load for t in terms)


def moves_links(terms: tuple[Term, ...]) -> bool:
    """Whether a term changes the rigid columns themselves."""
    return any(t.law.warp in (*LAGGING, "gravity") for t in terms)


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
        width: Width of every joint's smooth sign, (n,).
        pi: Rigid parameters (10 n,) that load-dependent and soft terms go by.
        rigid: Rigid columns of the plain motion in nominal gravity, where known.
        decimate: Whether to return the columns through the decimator, (T', n, p).

    Returns:
        Standard parameters first, then the linear parameters of the terms in their order.
    """
    low = motion.decimator.apply if decimate else np.asarray
    delays = warped(terms, "delay")
    if moves_links(terms) or rigid is None:
        arm, kept = tilted(robot, terms), None
        moved = link_motion(arm, terms, motion, pi, rigid)
        full = rigid_columns(arm, *moved)
        static = None
    else:
        full, static = rigid.full, rigid.static
        kept = rigid.low if decimate and not delays else None
    load = None
    if uses_load(terms):
        if static is None:
            static = rigid_columns(arm, moved[0], moved[1], np.zeros_like(moved[2]))
        load = load_of(full, static, pi)

    parts = [kept if kept is not None else low(full)]
    if warped(terms, "gain") or delays:
        parts = [low(report(terms, motion, full))]
    for term in terms:
        if term.columns(robot.joints):
            parts.append(low(report(terms, motion, own_columns(term, motion, width, load))))
    return np.concatenate(parts, axis=2)


def own_columns(
    term: Term, motion: Motion, width: Sequence[float], load: Load | None
) -> np.ndarray:
    """Columns of a term on the working clock, (T, n, k), zero on joints it does not act on."""
    if term.law.warp == "window":
        return window_columns(term, motion)
    own = term_columns(term, motion, width, load)
    block = np.zeros((len(own), motion.q.shape[1], own.shape[1]))
    block[:, term.joint] = own
    return block


def report(terms: tuple[Term, ...], motion: Motion, block: np.ndarray) -> np.ndarray:
    """Columns (T, n, k) as the drives report them: scaled by their gains, on a late clock."""
    for term in warped(terms, "gain"):
        block = block.copy()
        block[:, term.joint] *= term.values["gain"]
    for term in warped(terms, "delay"):
        block = np.asarray(_shift(block, term.values["seconds"], 1.0 / motion.rate))
    return block


def report_own(terms: tuple[Term, ...], motion: Motion, own: np.ndarray, joint: int) -> np.ndarray:
    """Columns (T, k) that act on one joint as its drive reports them."""
    scale = np.prod([t.values["gain"] for t in warped(terms, "gain") if t.joint == joint])
    for term in warped(terms, "delay"):
        own = np.asarray(_shift(own, term.values["seconds"], 1.0 / motion.rate))
    return own * scale


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
    load = load_of(rigid.full, rigid.static, pi) if term.law.uses_load else None
    return motion.decimator.apply(report(terms, motion, own_columns(term, motion, width, load)))


def window_columns(term: Term, motion: Motion) -> np.ndarray:
    """One constant torque per joint while a touch lasts, shape (T, n, n)."""
    inside = (motion.t >= term.values["start"]) & (motion.t <= term.values["end"])
    return inside[:, None, None] * np.eye(motion.q.shape[1])


_shift = jax.jit(shift)
