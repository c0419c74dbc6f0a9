r"""What a motor spends besides friction: rotor, springs, ripple, coupled gears.

References: W. Khalil, E. Dombre (2002), ch. 9 (rotor inertia, coupling); M. Spong, "Modeling and
control of elastic joint robots", J. Dyn. Sys. Meas. Control 109 (1987); A. Janot, P.-O. Vandanjon,
M. Gautier, IEEE TCST 22(1) (2014) for the wrist of the TX40.
"""

import jax.numpy as jnp

from jaxswarm.effects.base import Export, register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import ORDER, PHASE, Parameter
from jaxswarm.robot.trig import polynomial_sincos


def _rippling(p, s):
    sine, cosine = polynomial_sincos(p["n"] * s.q)
    return p["sine"] * sine + p["cosine"] * cosine


register(
    TorqueLaw(
        name="rotor_inertia",
        scope="joint",
        parameters=(
            Parameter("ia", "kg m^2", 0.0, 1e3, True, 0.1, "rotor inertia seen at the joint"),
        ),
        summary="ia ddq",
        reference="Khalil, Dombre 2002, eq. 9.11",
        meaning=(
            "The rotor turns faster than the link, and its inertia counts with the square of the "
            "gear ratio; often it is a part of the link inertia that the log cannot part."
        ),
        torque=lambda p, s: p["ia"] * s.ddq,
        motor_inertia="ia",
        everyday=True,
        shown_against="acceleration",
        export=(Export("mjcf", lambda p: {"armature": p["ia"]}),),
    )
)

register(
    TorqueLaw(
        name="torque_offset",
        scope="joint",
        parameters=(Parameter("tau0", "N m", -1e4, 1e4, True, 0.5, "constant torque"),),
        summary="tau0",
        reference="Khalil, Dombre 2002, ch. 12",
        meaning=(
            "A constant torque: the zero of the sensor or the current has moved, or something "
            "pulls steadily, such as a cable; zero the sensor at rest first."
        ),
        torque=lambda p, s: p["tau0"] + 0.0 * s.q,
        shown_against="model torque",
    )
)


def _spring_attributes(p):
    return {"stiffness": p["k"], "springref": -p.get("tau0", 0.0) / p["k"]}


register(
    TorqueLaw(
        name="joint_spring",
        scope="joint",
        parameters=(
            Parameter("k", "N m/rad", 0.0, 1e6, True, 10.0, "stiffness"),
            Parameter("tau0", "N m", -1e6, 1e6, True, 0.0, "torque at q = 0, -k q0"),
        ),
        summary="k (q - q0): balancer, cable",
        reference="Khalil, Dombre 2002, ch. 9",
        meaning=(
            "Something pulls back to one position: a balancer, a hose or a cable bundle; look at "
            "how cables are led if none is meant to be there."
        ),
        torque=lambda p, s: p["k"] * s.q + p["tau0"],
        # Without stiffness there is no position of rest.
        derived=lambda p: {"q0": (-p["tau0"] / p["k"], "rad")} if p["k"] else {},
        contains=("torque_offset",),
        shown_against="position",
        export=(Export("mjcf", _spring_attributes, adds=False, holds=lambda p: p["k"] > 0),),
    )
)

register(
    TorqueLaw(
        name="torque_ripple",
        scope="joint",
        parameters=(
            Parameter("sine", "N m", -1e4, 1e4, True, 0.5, "amplitude of sin(n q)"),
            Parameter("cosine", "N m", -1e4, 1e4, True, 0.5, "amplitude of cos(n q)"),
            Parameter("n", ORDER, 3.0, 200.0, False, 20.0, "order: periods per turn of the joint"),
        ),
        summary="a sin(n q + phase): cogging of the motor, teeth of the gear",
        reference="Holtz, Springob 1996, IEEE Trans. Ind. Electron. 43(2)",
        meaning=(
            "Torque repeats with the angle: cogging of the motor, teeth of a gear or an eccentric"
            " one; n tells which, as so many periods a turn."
        ),
        several=True,
        identity=("n",),
        way=lambda p: f"order {p['n']:.3g}",
        torque=_rippling,
        shown_against="position",
        # The order has a narrow valley: points lie 0.4 of an order apart.
        grid_size=480,
        derived=lambda p: {
            "a": (jnp.hypot(p["sine"], p["cosine"]), "N m"),
            "phase": (jnp.arctan2(p["cosine"], p["sine"]), PHASE),
        },
    )
)

register(
    TorqueLaw(
        name="transmission_coupling",
        scope="pair",
        parameters=(
            Parameter(
                "b", "N m s/rad", -1e4, 1e4, True, 1.0, "viscous, per velocity of the partner"
            ),
            Parameter("fc", "N m", -1e4, 1e4, True, 0.0, "dry, of the motor both joints turn"),
            Parameter(
                *("fd", "N m", -1e4, 1e4, True, 0.0, "dry, of a motor their difference turns"),
                # Which way axes point is how a robot is described: one of the two is usually nothing.
                usual=True,
            ),
            Parameter(
                "ia", "kg m^2", -1e3, 1e3, True, 0.0, "inertia, per acceleration of the partner"
            ),
        ),
        summary="b dq_other + fc sign(dq + dq_other) + fd sign(dq - dq_other) + ia ddq_other",
        reference="Janot, Vandanjon, Gautier 2014, IEEE TCST 22(1) (wrist of the TX40)",
        meaning=(
            "The motion of another joint is felt in this one, as in wrists whose drives run "
            "through each other; check the coupling ratio in the controller."
        ),
        torque=lambda p, s: (
            p["b"] * s.dq_other
            + p["fc"] * s.direction_sum
            + p["fd"] * s.direction_difference
            + p["ia"] * s.ddq_other
        ),
        uses_direction=True,
        shown_against="partner velocity",
    )
)
