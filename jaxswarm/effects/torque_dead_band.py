r"""A drive that gives nothing near zero torque, or a sensor that sees nothing there.

Of a command arrives what is beyond d, so that the command for a true torque :math:`\tau` is
:math:`\tau + d\,\mathrm{sign}\,\tau`; a sensor with a dead band writes down d less, the same with d below
zero, but for torques within the band. The true torque is that of the model with all its other terms. Told from
``coulomb_friction``, which goes with the sign of the velocity and not of the torque: where a joint neither
carries weight nor shares its motor the two are alike, and friction, which every drive has, is named.

Reference: G. Tao, P. V. Kokotovic, "Adaptive Control of Systems with Actuator and Sensor Nonlinearities"
(1996), ch. 2 (dead zone and its inverse).
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.parameter import Parameter

register(
    MeasurementLaw(
        name="torque_dead_band",
        scope="joint",
        parameters=(
            Parameter("d", "N m", -1e4, 1e4, True, 0.5, "torque of the command that is lost"),
        ),
        summary="measured torque = torque + d sign(torque): dead band of a drive or sensor",
        reference="Tao, Kokotovic 1996, Adaptive Control of Systems with Actuator Nonlinearities, ch. 2",
        meaning=(
            "Near zero the drive gives nothing, or the sensor sees nothing: dead time of the power "
            "stage, a worn coupling, a threshold in a filter; compensate it by its inverse."
        ),
        distortion=lambda p, torque: p["d"] * jnp.sign(torque),
        uses_load=True,
        shown_against="model torque",
    )
)
