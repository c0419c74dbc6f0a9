r"""The motion of links that lag behind their motors, and what it takes from the rigid parameters.

The lag e of a soft or loose joint follows the rigid torque (:mod:`jaxswarm.effects.warps`), so the torque
is no longer linear in the rigid parameters :math:`\pi`: near resonance the lag decides the fit that decides
the lag. :func:`lag_slopes` gives the missing part of the derivative,
:math:`-(\tau_q\,\partial e + \tau_{\dot q}\,\partial\dot e + \tau_{\ddot q}\,\partial\ddot e)/\partial\pi`.
"""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from scipy import ndimage

from jaxswarm.effects.warps import contact_stiffness, deflection
from jaxswarm.identify.columns import rigid_columns
from jaxswarm.identify.terms import Term, warped
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


def lag_slopes(robot: Robot, terms: tuple[Term, ...], motion: Motion, pi: np.ndarray) -> np.ndarray:
    """Derivative of the torque by the rigid parameters that runs through the lag of soft joints.

    To first order about the motors' motion, shape (T, n, 10 n).
    """
    total = np.zeros((*motion.q.shape, len(pi)))
    for term in warped(terms, "elastic"):
        j = term.joint
        sensed = sensitivity_columns(robot, motion, j)
        own = np.stack([x[:, j] for x in sensed])
        felt = np.flatnonzero(np.abs(own).max(axis=(0, 1)) > 0)
        k, d = (jnp.asarray(term.values[name], float) for name in ("k", "d"))
        lags = _lag_directions(own @ pi, own[:, :, felt], k, d, 1.0 / motion.rate)
        for by, lag in zip(sensed[1:], lags, strict=True):
            total[:, :, felt] -= (by @ pi)[:, :, None] * np.asarray(lag)[:, None, :]
    return total


@jax.jit
def _lag_directions(own, directions, k, d, step):
    """Derivatives (T, m) of e, de, dde along m directions (4, T, m) of torque and sensitivities."""

    def lag(signals):
        torque, by_q, by_dq, by_ddq = signals
        return deflection(by_ddq, by_dq, by_q, torque, k, d, jnp.zeros_like(k), step)

    along = partial(jax.jvp, lag, (own,))
    return jax.vmap(lambda x: along((x,))[1], in_axes=2, out_axes=1)(directions)
