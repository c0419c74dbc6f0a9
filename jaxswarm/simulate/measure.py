"""What is logged of a motion: gain and delay between the true torque and the recorded one."""

import jax
import jax.numpy as jnp

from jaxswarm.simulate.plant import Plant
from jaxswarm.simulate.rollout import Trajectory


def measured_torque(plant: Plant, motion: Trajectory) -> jax.Array:
    """Return the torques (T, n) as a drive with gains and a late clock records them, in N m or N.

    ``drive_gain`` multiplies a joint's torque; ``time_delay`` shows at time t the torque of the motion
    at t - seconds, interpolated linearly. Without either it is ``motion.tau``.
    """
    tau = motion.tau
    for acting in plant.acting:
        if acting.law.warp == "gain":
            tau = tau.at[:, acting.joint].multiply(acting.values["gain"])
        elif acting.law.warp == "delay":
            late = motion.t - acting.values["seconds"]
            flat = tau.reshape(tau.shape[0], -1)
            columns = jax.vmap(lambda x, late=late: jnp.interp(late, motion.t, x), 1, 1)(flat)
            tau = columns.reshape(tau.shape)
    return tau
