"""What is logged of a motion: drives and clock between the true torque and the recorded one."""

import jax
import jax.numpy as jnp

from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.term import of_kind
from jaxswarm.simulate.plant import Plant
from jaxswarm.simulate.rollout import Trajectory


def measured_torque(plant: Plant, motion: Trajectory) -> jax.Array:
    """Return the torques (T, n) as the plant's drives and their clock write them down, in N m or N.

    Without a :class:`MeasurementLaw` it is ``motion.tau``.
    """
    tau = motion.tau
    step = motion.t[1] - motion.t[0]
    measured = sorted(of_kind(plant.acting, MeasurementLaw), key=lambda a: a.law.turn)
    for acting in measured:
        if acting.law.distortion is not None:
            beside = acting.law.distortion(acting.values, motion.tau[:, acting.joint])
            tau = tau.at[:, acting.joint].add(beside)
    true = tau
    for acting in measured:
        if acting.joint is None:
            tau = acting.law.report(acting.values, tau, step)
            continue
        own = tau[:, acting.joint]
        if acting.law.crosses:
            own = jnp.stack([own, true[:, acting.other]], axis=1)
        tau = tau.at[:, acting.joint].set(acting.law.report(acting.values, own, step))
    return tau
