"""Controllers: functions of what the encoders say and of the reference, called at their own rate.

A controller is a frozen pytree with a method-free law: ``command(controller, robot, measured,
reference) -> tau``. All arrays are (n,) entries of one sample, so a population of plants can be held by
one controller in lanes.
"""

import dataclasses
from typing import NamedTuple, Protocol

import jax
import jax.numpy as jnp

from jaxswarm.nodes import node
from jaxswarm.robot.dynamics import inverse_dynamics
from jaxswarm.robot.model import Robot


class Reference(NamedTuple):
    """Where the arm should be: (n,) each, or (T, n) for a whole motion; feedforward in N m or N."""

    q: jax.Array
    dq: jax.Array
    ddq: jax.Array
    feedforward: jax.Array


class Controller(Protocol):
    """What a closed loop needs."""

    def command(self, q: jax.Array, dq: jax.Array, reference: Reference) -> jax.Array:
        """Return the motor torques (n,) for encoder position and velocity (n,)."""


def _column(gain: jax.Array | float, like: jax.Array) -> jax.Array:
    column = jnp.asarray(gain, like.dtype)
    return (
        column.reshape(column.shape + (1,) * (like.ndim - column.ndim)) if column.ndim else column
    )


@node
@dataclasses.dataclass(frozen=True, eq=False)
class PD:
    """tau = feedforward + kp (q_ref - q) + kd (dq_ref - dq), limited to +- limit.

    Attributes:
        kp: (n,) or scalar, in N m/rad or N/m.
        kd: (n,) or scalar, in N m s/rad or N s/m.
        limit: (n,) or scalar, in N m or N.
    """

    kp: jax.Array
    kd: jax.Array
    limit: jax.Array | float = float("inf")

    def command(self, q, dq, reference: Reference):
        """Return the motor torques (n,)."""
        kp, kd, limit = (_column(x, q) for x in (self.kp, self.kd, self.limit))
        tau = reference.feedforward + kp * (reference.q - q) + kd * (reference.dq - dq)
        return jnp.clip(tau, -limit, limit)


@node
@dataclasses.dataclass(frozen=True, eq=False)
class Cascade:
    """tau = gain clip(kp kv (q_ref - q) - kv dq, +- limit): position over velocity loop in volts.

    Attributes:
        kp: Position gain in 1/s.
        kv: Velocity gain in V s/m (or V s/rad).
        gain: Force per volt in N/V.
        limit: Largest command in V.
    """

    kp: jax.Array
    kv: jax.Array
    gain: jax.Array | float = 1.0
    limit: jax.Array | float = float("inf")

    def command(self, q, dq, reference: Reference):
        """Return the motor torques (n,)."""
        kp, kv, gain, limit = (_column(x, q) for x in (self.kp, self.kv, self.gain, self.limit))
        volts = kp * kv * (reference.q - q) - kv * dq
        return reference.feedforward + gain * jnp.clip(volts, -limit, limit)


@node
@dataclasses.dataclass(frozen=True, eq=False)
class ComputedTorque:
    """tau = feedforward + ID(q, dq, ddq_ref + kp (q_ref - q) + kd (dq_ref - dq)), limited.

    Attributes:
        model: The robot as the controller believes it to be.
        kp: (n,) or scalar, in 1/s^2.
        kd: (n,) or scalar, in 1/s.
        limit: (n,) or scalar, in N m or N.
    """

    model: Robot
    kp: jax.Array
    kd: jax.Array
    limit: jax.Array | float = float("inf")

    def command(self, q, dq, reference: Reference):
        """Return the motor torques (n,)."""
        kp, kd, limit = (_column(x, q) for x in (self.kp, self.kd, self.limit))
        wanted = reference.ddq + kp * (reference.q - q) + kd * (reference.dq - dq)
        tau = reference.feedforward + inverse_dynamics(self.model, q, dq, wanted)
        return jnp.clip(tau, -limit, limit)
