r"""A drive whose torque is not in proportion to what it writes down: iron that saturates, a sensor that bends.

Written down is :math:`\tau (1 - c\,|\tau|\,|\tau/\tau_a|^{n-1})` of a true torque :math:`\tau`. Iron in
saturation gives less torque per ampere, so that a log of current times constant says too much of a large
torque (c below zero); an amplifier near its end says too little. The exponent n is 1, and :math:`\tau_a` of no
account, as long as a log does not tell another: iron that bends only where it is nearly full has a larger one,
2 as in :math:`k\tau/(1 + (\tau/s)^2)`. Held at 1 there, what it left of large torques was told as contacts
beside it. Then c is that at :math:`\tau_a`, the largest torque of the log: at 1 N m it would hardly be known on
a joint that bears 200. The true torque is that of the model with all its other terms, never the measured one.
It is no line through zero, so that it shows on a single joint too. Told from ``drive_gain``, which is the same
at any torque, and from ``load_dependent_friction``, which changes its sign with the velocity.

Reference: P. I. Corke, "In situ measurement of robot motor electrical constants", Robotica 14(4) (1996).
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.parameter import Parameter


def _bent(p, torque):
    # A power has no derivative at zero for n < 1: keep the base away from it.
    size = jnp.abs(torque)
    return -p["c"] * torque * size * ((size + 1e-9) / p["at"]) ** (p["n"] - 1.0)


register(
    MeasurementLaw(
        name="torque_constant_saturation",
        scope="joint",
        parameters=(
            Parameter("c", "1/(N m)", -10.0, 10.0, True, 0.001, "fall of the gain per torque"),
            Parameter(
                "n", "1", 0.5, 4.0, False, 1.0, "exponent of the fall", shown_by=("c",), usual=True
            ),
            Parameter(
                "at",
                "N m",
                1e-6,
                1e6,
                False,
                1.0,
                "torque at which c is told, unless n is 1",
                "log",
                fitted=False,
                lies="torque",
            ),
        ),
        summary="measured torque = torque (1 - c |torque| |torque/at|^(n - 1)): gain changes with torque",
        reference="Corke 1996, Robotica 14(4)",
        meaning=(
            "Large torques are not written down in proportion to small ones: iron of the motor in "
            "saturation, or an amplifier at its end; calibrate the torque constant over its range."
        ),
        distortion=_bent,
        uses_load=True,
        shown_against="model torque",
    )
)
