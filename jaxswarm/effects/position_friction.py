r"""Dry friction that varies with the position of the joint: a worn spot, an eccentric gear, a bent shaft.

The level goes around with the joint, :math:`\sin(n q)` and :math:`\cos(n q)` times the sign of the velocity,
on top of the constant level of Coulomb friction. Told from ``torque_ripple``, which does not change its sign
with the velocity, and from ``load_dependent_friction``, of fewer parameters, which says the same where the
load goes with this joint's position alone: an arm in a vertical plane. A motion of the joints that carry the
weight tells those two apart.

Reference: A. C. Bittencourt, S. Gunnarsson, "Static friction in a robot joint: modeling and identification
of load and temperature effects", J. Dyn. Sys. Meas. Control 134 (2012), section 2 (dependence on position).
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import ORDER, PHASE, Parameter
from jaxswarm.robot.trig import polynomial_sincos


def _varying(p, s):
    sine, cosine = polynomial_sincos(p["n"] * s.q)
    return (p["sine"] * sine + p["cosine"] * cosine) * s.direction


register(
    TorqueLaw(
        name="position_dependent_friction",
        scope="joint",
        parameters=(
            Parameter("sine", "N m", -1e4, 1e4, True, 0.5, "amplitude of sin(n q)"),
            Parameter("cosine", "N m", -1e4, 1e4, True, 0.5, "amplitude of cos(n q)"),
            # Up to a wave of some centimeters on a slide; below one per turn it is a trend.
            Parameter(
                "n", ORDER, 0.8, 60.0, False, 1.0, "order: periods per turn of the joint", "log"
            ),
        ),
        summary="(a sin(n q) + b cos(n q)) sign(dq), on top of Coulomb",
        reference="Carvalho Bittencourt, Gunnarsson 2012, J. Dyn. Sys. Meas. Control 134(5)",
        meaning=(
            "The joint rubs harder in some places of its turn: a worn spot, an eccentric gear, a bent "
            "shaft; look there, or compensate by the position."
        ),
        torque=_varying,
        shown_against="position",
        uses_direction=True,
        # Points lie 7 % of an order apart, less than half a period over a turn up to an order of seven.
        grid_size=64,
        derived=lambda p: {
            "a": (jnp.hypot(p["sine"], p["cosine"]), "N m"),
            "phase": (jnp.arctan2(p["cosine"], p["sine"]), PHASE),
        },
    )
)
