r"""What a base that gives way does to the torque, to first order about a base that does not.

The moment M of the base follows from the rigid body on hinges; with :math:`\theta = -c M` and its derivatives,
of M below the cutoff of the torque (above it there is noise differentiated four times),
:math:`\tau_\theta \theta + \tau_{\dot\theta} \dot\theta + \tau_{\ddot\theta} \ddot\theta` are the columns.
"""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.hinged_base import TURNS, hinged
from jaxswarm.effects.kinds import BodyChange
from jaxswarm.identify.forward.lengths import chunks
from jaxswarm.logs.filtering import derivatives
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.smoothing import smooth
from jaxswarm.robot import inverse_dynamics
from jaxswarm.robot.model import Robot


@jax.jit
def _moment(robot: Robot, *motion: jax.Array) -> jax.Array:
    """Moments (T, 2) that hold the base of a hinged robot where it is, for q, dq, ddq (T, n) of its arm."""
    still = [jnp.pad(x, ((0, 0), (TURNS, 0))) for x in motion]
    return jax.vmap(partial(inverse_dynamics, robot))(*still)[:, :TURNS]


@jax.jit
def _felt(robot: Robot, sway: jax.Array, *motion: jax.Array) -> jax.Array:
    """Torque (T, n) of the joints by a small sway (T, 3, 2) of the base: turns and two derivatives."""

    def torque(base, q, dq, ddq):
        whole = [jnp.concatenate(x) for x in zip(base, (q, dq, ddq), strict=True)]
        return inverse_dynamics(robot, *whole)[TURNS:]

    def one(base, q, dq, ddq):
        at = partial(torque, q=q, dq=dq, ddq=ddq)
        return jax.jvp(at, (jnp.zeros_like(base),), (base,))[1]

    return jax.vmap(one)(sway, *motion)


def compliance_columns(
    law: BodyChange, arm: Robot, moved: tuple[np.ndarray, ...], pi: np.ndarray, motion: Motion
) -> np.ndarray:
    """Torque (T, n, k) by the linear parameters of a compliance.

    Args:
        law: A law with a compliance.
        arm: The robot in its gravity.
        moved: Motion of the links, q, dq, ddq, each (T, n).
        pi: Rigid parameters, (10 n,).
        motion: The log, for its rate and the cutoff of its torque.
    """
    body = jnp.asarray(np.asarray(pi, float).reshape(-1, 10))
    robot = hinged(arm.replace(parameters=body))
    moment = np.concatenate([np.asarray(_moment(robot, *x)) for x in chunks(moved)])[
        : len(motion.t)
    ]
    moment = smooth(moment, motion.rate, motion.torque_cutoff)
    along = np.stack([moment, *derivatives(moment, motion.rate, 2)], axis=1)
    none = {p.name: 0.0 for p in law.linear}
    columns = []
    for p in law.linear:
        sway = -along * np.asarray(law.compliance({**none, p.name: 1.0}))
        parts = [np.asarray(_felt(robot, *x)) for x in chunks((sway, *moved))]
        columns.append(np.concatenate(parts)[: len(motion.t)])
    return np.stack(columns, axis=2)
