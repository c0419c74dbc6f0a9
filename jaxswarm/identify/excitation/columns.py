"""The columns of a model along a planned motion, and their condition number.

The same numbers as :mod:`jaxswarm.identify.forward.columns` computes from a log, but as one traceable
function of the motion, samples as lanes, for a search over motions.
"""

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.sample import Sample
from jaxswarm.effects.series import law_columns, law_torque
from jaxswarm.effects.term import Term
from jaxswarm.errors import InputError
from jaxswarm.identify.excitation.fourier import within_limits
from jaxswarm.identify.excitation.limits import Limits
from jaxswarm.robot import inverse_dynamics, regressor
from jaxswarm.robot.model import Robot

# Position, velocity and acceleration along a period, each (n, K).
_Signal = jax.Array | np.ndarray
Planned = tuple[_Signal, _Signal, _Signal]
_WIDTH = 0.01  # of the smooth sign, as a share of the velocity limit


def plannable(term: Term, joints: tuple[str, ...], load_known: bool = False) -> bool:
    """Whether the columns of a term follow from the motion, or from it and the load where that is known."""
    if not isinstance(term.law, TorqueLaw):
        return False
    t, q, dq, ddq = np.ones((4, len(joints), 2))
    columns = _law_columns(term, t, q, dq, ddq, 1.0, None)
    return not np.isnan(columns).any() and (load_known or not term.law.uses_load)


def refuse_terms(
    terms: tuple[Term, ...],
    joints: tuple[str, ...],
    load_known: bool = False,
    option: str = "--effects",
) -> None:
    """Refuse effects whose columns do not follow from the motion alone.

    Raises:
        InputError: On an effect that is no torque of a joint, on a law that needs a temperature, or on one
            that needs the load where that is not known.
    """
    for term in terms:
        if plannable(term, joints, load_known):
            continue
        if isinstance(term.law, TorqueLaw) and term.law.uses_load and not load_known:
            remedy = (
                f"leave it out of {option}, or give the load by --separate A,B --given MODEL.json"
            )
        else:
            remedy = (
                f"leave it out of {option}: possible are torques of a joint that follow from position, "
                "velocity and acceleration, such as frictions, springs, ripple, inertias and couplings"
            )
        raise InputError(
            f"effect {term.label(joints)} has no columns that follow from the motion alone, so no "
            f"motion can be planned for it; {remedy}"
        )


def log_condition(columns: jax.Array) -> jax.Array:
    """Logarithm of the condition number of columns (b, N), each scaled to length one.

    >>> round(float(jnp.exp(log_condition(jnp.array([[3.0, 0.0], [1.0, 1.0]])))), 4)
    2.4142
    """
    # A report asks this module what can be planned, and needs no swarm for it.
    from jaxswarm.swarm.optimizers.products import over_columns

    scaled = columns / jnp.maximum(jnp.linalg.norm(columns, axis=1, keepdims=True), 1e-30)
    spectrum = jnp.linalg.eigvalsh(over_columns(scaled, scaled))
    tiny = jnp.finfo(spectrum.dtype).eps
    return 0.5 * jnp.log(spectrum[-1] / jnp.maximum(spectrum[0], tiny * spectrum[-1]))


def condition(columns: np.ndarray) -> float:
    """Condition number of columns (b, N), each scaled to length one, by singular values."""
    size = np.linalg.norm(columns, axis=1, keepdims=True)
    return float(np.linalg.cond(columns / np.maximum(size, 1e-300)))


def planned(x: jax.Array, limits: Limits, fundamental: float, samples: int) -> Planned:
    """Motion of one period, each (n, samples)."""
    offset, sine, cosine = within_limits(x, limits, fundamental, samples)
    order = np.arange(1, limits.harmonics + 1)
    angle = 2 * np.pi * np.outer(order, np.arange(samples) / samples)
    s, c, w = np.sin(angle), np.cos(angle), 2 * np.pi * fundamental * order
    q = offset[:, None] + sine @ s + cosine @ c
    return q, (sine * w) @ c - (cosine * w) @ s, -(sine * w**2) @ s - (cosine * w**2) @ c


def planned_columns(
    robot: Robot,
    terms: tuple[Term, ...],
    limits: Limits,
    q,
    dq,
    ddq,
    period: float,
    pi: np.ndarray | None = None,
    tangents: bool = False,
) -> jax.Array:
    """Columns of a model along a motion given as (n, K), shape (p, n K).

    Args:
        robot: Kinematics.
        terms: Effects; nonlinear parameters at their values, or at nominal ones.
        limits: Whose velocities set the width of the smooth sign.
        q, dq, ddq: One period of the motion.
        period: Its length [s].
        pi: Rigid-body parameters (10 n,) for laws that need the load; None: it is not known.
        tangents: Whether each term has columns for its nonlinear parameters too, at usual linear ones.
    """
    n, samples = q.shape
    rigid = jnp.swapaxes(regressor(robot, q, dq, ddq), 0, 1)
    parts, load = [rigid], None
    if pi is not None and any(term.law.uses_load for term in terms):
        still = jnp.swapaxes(regressor(robot, q, dq, jnp.zeros_like(ddq)), 0, 1)
        load = jnp.tensordot(pi, rigid, 1), jnp.tensordot(pi, still, 1)
    t = jnp.broadcast_to(np.arange(samples) * period / samples, q.shape)
    for term in terms:
        width = _WIDTH * limits.velocity[term.index]
        own = _law_columns(term, t, q, dq, ddq, width, load, tangents)
        block = jnp.zeros((own.shape[1], n, samples), q.dtype)
        parts.append(block.at[:, term.index].set(own.T))
    return jnp.concatenate(parts).reshape(-1, n * samples)


def planned_torque(
    robot: Robot, terms: tuple[Term, ...], limits: Limits, q, dq, ddq, period: float
) -> jax.Array:
    """Torque of a robot with masses and of terms with values along a motion of arrays (n, K), (n, K)."""
    rigid = inverse_dynamics(robot, q, dq, ddq)
    still = inverse_dynamics(robot, q, dq, jnp.zeros_like(ddq))
    t = jnp.broadcast_to(np.arange(q.shape[1]) * period / q.shape[1], q.shape)
    torque = rigid
    for term in terms:
        width = _WIDTH * limits.velocity[term.index]
        own = _law_columns(term, t, q, dq, ddq, width, (rigid, still))
        linear = np.array([term.values[p.name] for p in term.law.linear])
        torque = torque.at[term.index].add(own @ linear)
    return torque


def _law_columns(term: Term, t, q, dq, ddq, width, load, tangents=False) -> jax.Array:
    """Columns (K, k) of one term's linear parameters on its own joint; then of its nonlinear ones."""
    law, j = term.law_of(TorqueLaw), term.index
    other = j if term.other is None else term.other
    zero = jnp.zeros_like(q[j])
    sample = Sample(
        t=t[j], q=q[j], dq=dq[j], ddq=ddq[j], direction=jnp.tanh(dq[j] / width),
        load=zero if load is None else load[0][j],
        static_load=zero if load is None else load[1][j],
        temperature=zero + jnp.nan,
        dq_other=dq[other], ddq_other=ddq[other],
        direction_sum=jnp.tanh((dq[j] + dq[other]) / width),
        direction_difference=jnp.tanh((dq[j] - dq[other]) / width), state=zero,
        q_other=q[other],
    )  # fmt: skip
    known = {**term.law.nominal(), **term.values}
    nonlinear = {p.name: jnp.asarray(known[p.name], q.dtype) for p in term.law.nonlinear}
    columns = law_columns(law, nonlinear, sample)
    free = {p.name: nonlinear[p.name] for p in term.law.free(known)}
    if not (tangents and free):
        return columns
    # The usual linear values: those of a fit may be zero, and then nothing bends.
    usual = {p.name: jnp.asarray(p.nominal, q.dtype) for p in term.law.linear}
    bent = jax.jacfwd(lambda p: law_torque(law, {**usual, **nonlinear, **p}, sample))(free)
    return jnp.concatenate([columns, jnp.stack(list(bent.values()), axis=1)], axis=1)
