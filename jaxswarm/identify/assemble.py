r"""All columns of a model with its warps: what the rigid body really did, on which clock, on which scale.

The order in which a torque comes about fixes the order here: the links move (``joint_elasticity``,
``backlash``) in a gravity (``base_tilt``), the motors add their laws, the drive scales what it reports
(``drive_gain``) and the log's clock may lag (``time_delay``).
"""

import jax
import jax.numpy as jnp
import numpy as np
from scipy import ndimage

from jaxswarm.effects.warps import contact_stiffness, deflection, shift
from jaxswarm.identify.columns import Load, Rigid, load_of, rigid_columns, term_columns
from jaxswarm.identify.terms import Term
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot

# Uncertainty [s] of the moment at which a loose link strikes.
_STRIKE = 0.12


def sensitivity_columns(robot: Robot, motion: Motion, joint: int) -> tuple[np.ndarray, ...]:
    """Rigid columns (T, n, 10 n) and their derivatives by position, velocity, acceleration of a joint.

    Differences of the regressor: exact for the acceleration, in which the torque is linear.
    """
    here = (motion.q, motion.dq, motion.ddq)
    slopes = []
    for argument, step in enumerate((1e-5, 1e-4, 1.0)):
        high, low = list(here), list(here)
        axis = step * (np.arange(robot.num_joints) == joint)
        high[argument], low[argument] = here[argument] + axis, here[argument] - axis
        slopes.append((rigid_columns(robot, *high) - rigid_columns(robot, *low)) / (2.0 * step))
    return rigid_columns(robot, *here), *slopes


def sensitivity(robot: Robot, motion: Motion, joint: int, pi: np.ndarray) -> tuple[np.ndarray, ...]:
    """Rigid torque (T, n) and its derivatives by position, velocity, acceleration of one joint."""
    return tuple(columns @ pi for columns in sensitivity_columns(robot, motion, joint))


def term_deflection(term: Term, motion: Motion, sensed: tuple) -> tuple[np.ndarray, ...]:
    """Lag of the link of a soft or loose joint along a log: e, de, dde, each (T,)."""
    torque, by_q, by_dq, by_ddq = (x[:, term.joint] for x in sensed)
    if term.effect == "backlash":
        k, d = contact_stiffness(by_ddq)
        gap = term.values["gap"]
    else:
        k, d, gap = term.values["k"], term.values["d"], 0.0
    lag = deflection(
        by_ddq, by_dq, by_q, torque, jnp.asarray(k, float), jnp.asarray(d, float),
        jnp.asarray(gap, float), 1.0 / motion.rate,
    )  # fmt: skip
    if term.effect != "backlash":
        return tuple(np.asarray(x) for x in lag)
    # When the link strikes is uncertain by torques below the noise: the mean over that uncertainty.
    size = max(1, round(_STRIKE * motion.rate))
    return tuple(ndimage.uniform_filter1d(np.asarray(x), size, mode="nearest") for x in lag)


def warped(terms: tuple[Term, ...], name: str) -> list[Term]:
    """The terms that act through the named warp."""
    return [t for t in terms if t.law.warp == name]


def tilted(robot: Robot, terms: tuple[Term, ...]) -> Robot:
    """The robot in the gravity its ``base_tilt`` term says; the magnitude is kept."""
    robot_gravity = np.asarray(robot.gravity)
    for term in warped(terms, "gravity"):
        size = np.linalg.norm(robot_gravity)
        xy = np.array([term.values["gx"], term.values["gy"]])
        down = np.sign(robot_gravity[2]) * np.sqrt(max(size**2 - xy @ xy, 0.0))
        robot = robot.replace(gravity=jnp.array([*xy, down]))
    return robot


def link_motion(
    robot: Robot, terms: tuple[Term, ...], motion: Motion, pi: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Motion (q, dq, ddq) of the links where some lag behind their motors."""
    q, dq, ddq = motion.q.copy(), motion.dq.copy(), motion.ddq.copy()
    for term in warped(terms, "elastic") + warped(terms, "play"):
        lag = term_deflection(term, motion, sensitivity(robot, motion, term.joint, pi))
        for x, e in zip((q, dq, ddq), lag, strict=True):
            x[:, term.joint] -= np.asarray(e)
    return q, dq, ddq


def uses_load(terms: tuple[Term, ...]) -> bool:
    """Whether a term's columns depend on the rigid torque."""
    return any(t.law.uses_load for t in terms)


def moves_links(terms: tuple[Term, ...]) -> bool:
    """Whether a term changes the rigid columns themselves."""
    return any(t.law.warp in ("elastic", "play", "gravity") for t in terms)


def assemble(
    robot: Robot,
    terms: tuple[Term, ...],
    motion: Motion,
    width: float,
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
        moved = link_motion(arm, terms, motion, pi)
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


def own_columns(term: Term, motion: Motion, width: float, load: Load | None) -> np.ndarray:
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


def term_block(
    robot: Robot,
    terms: tuple[Term, ...],
    term: Term,
    motion: Motion,
    width: float,
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
