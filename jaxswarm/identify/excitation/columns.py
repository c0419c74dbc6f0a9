"""The columns of a model along a planned motion, and their condition number.

The same numbers as :mod:`jaxswarm.identify.forward.columns` computes from a log, but as one traceable
function of the motion, samples as lanes, for a search over motions.
"""

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.sample import Sample
from jaxswarm.effects.series import law_columns
from jaxswarm.effects.term import Term
from jaxswarm.errors import InputError
from jaxswarm.identify.excitation.fourier import within_limits
from jaxswarm.identify.excitation.limits import Limits
from jaxswarm.robot import regressor
from jaxswarm.robot.model import Robot

_WIDTH = 0.01  # of the smooth sign, as a share of the velocity limit


def refuse_terms(terms: tuple[Term, ...], joints: tuple[str, ...]) -> None:
    """Refuse effects whose columns do not follow from the motion alone.

    Raises:
        InputError: On an effect that is no torque of a joint, or on a law that needs the load or a temperature.
    """
    for term in terms:
        law = term.law
        heat = bool(np.isnan(_law_columns(term, *np.ones((4, len(joints), 2)), 1.0)).any())
        if not isinstance(law, TorqueLaw) or law.uses_load or heat:
            raise InputError(
                f"effect {term.label(joints)} has no columns that follow from the motion alone, so no "
                "motion can be planned for it; leave it out of --effects"
            )


def log_condition(columns: jax.Array) -> jax.Array:
    """Logarithm of the condition number of columns (b, N), each scaled to length one.

    >>> round(float(jnp.exp(log_condition(jnp.array([[3.0, 0.0], [1.0, 1.0]])))), 4)
    2.4142
    """
    scaled = columns / jnp.maximum(jnp.linalg.norm(columns, axis=1, keepdims=True), 1e-30)
    spectrum = jnp.linalg.eigvalsh(scaled @ scaled.T)
    tiny = jnp.finfo(spectrum.dtype).eps
    return 0.5 * jnp.log(spectrum[-1] / jnp.maximum(spectrum[0], tiny * spectrum[-1]))


def condition(columns: np.ndarray) -> float:
    """Condition number of columns (b, N), each scaled to length one, by singular values."""
    size = np.linalg.norm(columns, axis=1, keepdims=True)
    return float(np.linalg.cond(columns / np.maximum(size, 1e-300)))


def planned(x: jax.Array, limits: Limits, fundamental: float, samples: int) -> tuple:
    """Motion of one period, each (n, samples)."""
    offset, sine, cosine = within_limits(x, limits, fundamental, samples)
    order = np.arange(1, limits.harmonics + 1)
    angle = 2 * np.pi * np.outer(order, np.arange(samples) / samples)
    s, c, w = np.sin(angle), np.cos(angle), 2 * np.pi * fundamental * order
    q = offset[:, None] + sine @ s + cosine @ c
    return q, (sine * w) @ c - (cosine * w) @ s, -(sine * w**2) @ s - (cosine * w**2) @ c


def planned_columns(
    robot: Robot, terms: tuple[Term, ...], limits: Limits, q, dq, ddq, period: float
) -> jax.Array:
    """Columns of a model along a motion given as (n, K), shape (p, n K)."""
    n, samples = q.shape
    parts = [jnp.swapaxes(regressor(robot, q, dq, ddq), 0, 1)]
    t = jnp.broadcast_to(np.arange(samples) * period / samples, q.shape)
    for term in terms:
        own = _law_columns(term, t, q, dq, ddq, _WIDTH * limits.velocity[term.joint])
        block = jnp.zeros((own.shape[1], n, samples), q.dtype)
        parts.append(block.at[:, term.joint].set(own.T))
    return jnp.concatenate(parts).reshape(-1, n * samples)


def _law_columns(term: Term, t, q, dq, ddq, width) -> jax.Array:
    """Columns (K, k) of one term's linear parameters on its own joint."""
    if not isinstance(term.law, TorqueLaw):
        return jnp.zeros((q.shape[1], len(term.law.linear)))
    j = term.joint
    other = j if term.other is None else term.other
    zero = jnp.zeros_like(q[j])
    sample = Sample(
        t=t[j], q=q[j], dq=dq[j], ddq=ddq[j], direction=jnp.tanh(dq[j] / width),
        load=zero, static_load=zero, temperature=zero + jnp.nan,
        dq_other=dq[other], ddq_other=ddq[other],
        direction_sum=jnp.tanh((dq[j] + dq[other]) / width), state=zero,
        q_other=q[other],
    )  # fmt: skip
    nonlinear = {p.name: jnp.asarray(p.nominal, q.dtype) for p in term.law.nonlinear}
    return law_columns(term.law, nonlinear, sample)
