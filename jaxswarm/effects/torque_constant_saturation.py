r"""A drive whose torque is not in proportion to what it writes down: iron that saturates, a sensor that bends.

Written down is :math:`\tau (1 - c\,|\tau|)` of a true torque :math:`\tau`. Iron in saturation gives less torque
per ampere, so that a log of current times constant says too much of a large torque (c below zero); an
amplifier near its end says too little. The true torque is that of the model with all its other terms, never
the measured one. It is no line through zero, so that it shows on a single joint too. Told from
``drive_gain``, which is the same at any torque, and from ``load_dependent_friction``, which changes its sign
with the velocity.

Reference: P. I. Corke, "In situ measurement of robot motor electrical constants", Robotica 14(4) (1996).
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.parameter import Parameter

register(
    MeasurementLaw(
        name="torque_constant_saturation",
        scope="joint",
        parameters=(
            Parameter("c", "1/(N m)", -10.0, 10.0, True, 0.001, "fall of the gain per torque"),
        ),
        summary="measured torque = torque (1 - c |torque|): gain changes with torque",
        reference="Corke 1996, Robotica 14(4)",
        meaning=(
            "Large torques are not written down in proportion to small ones: iron of the motor in "
            "saturation, or an amplifier at its end; calibrate the torque constant over its range."
        ),
        distortion=lambda p, torque: -p["c"] * torque * jnp.abs(torque),
        uses_load=True,
        shown_against="model torque",
    )
)
