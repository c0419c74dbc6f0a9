"""What is logged of a motion: drives and clock between the true torque and the recorded one."""

import jax

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
    for acting in of_kind(plant.acting, MeasurementLaw):
        if acting.joint is None:
            tau = acting.law.report(acting.values, tau, step)
        else:
            own = tau[:, acting.joint]
            if acting.law.distortion is not None:
                own = own + acting.law.distortion(acting.values, own)
            own = acting.law.report(acting.values, own, step)
            tau = tau.at[:, acting.joint].set(own)
    return tau
