r"""A spring mechanism that carries the weight of an arm: a coil or gas spring on a lever.

A spring between a point of the link at radius r and one of the base at distance d from the axis has the
length :math:`\sqrt{r^2 + d^2}\,\sqrt{1 + b \cos x}`, with x the angle from where the three points are in line
and :math:`b = 2 r d/(r^2 + d^2)`. Its torque is :math:`a \sin 2x / \sqrt{1 + b \cos x}` where the force goes
with the lever's projection. One of constant force or with preload gives :math:`\sin x` over the same root: of
that the weight takes up the sine, and what remains is of the same form to second order in b. Turning q0 by
half a turn is the same as changing the sign of b, so that b is positive. Told from ``joint_spring`` and
``cubic_spring``, which have fewer parameters, by a motion over more than a radian. A slide has no such lever.

Reference: V. Arakelian, "Gravity compensation in robotics", Advanced Robotics 30(2) (2016), section 3.
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import Parameter
from jaxswarm.robot.trig import polynomial_sincos


def _lever(p, s):
    sine, cosine = polynomial_sincos(s.q - p["q0"])
    return p["a"] * (2.0 * sine * cosine) / jnp.sqrt(1.0 + p["b"] * cosine)


register(
    TorqueLaw(
        name="gravity_compensator",
        scope="joint",
        parameters=(
            Parameter("a", "N m", -1e5, 1e5, True, 10.0, "torque of the spring on its lever"),
            Parameter("b", "1", 0.02, 0.98, False, 0.3, "2 r d/(r^2 + d^2) of the lever"),
            Parameter("q0", "rad", -3.15, 3.15, False, 0.0, "where the lever is in line"),
        ),
        summary="a sin(2(q - q0)) / sqrt(1 + b cos(q - q0)): spring on a lever",
        reference="Arakelian 2016, Advanced Robotics 30(2)",
        meaning=(
            "A spring or gas cylinder on a lever carries a part of the weight; declare it if the arm "
            "has one, and if its torque fell look at spring, preload or gas pressure."
        ),
        torque=_lever,
        turning=True,
        shown_against="position",
        # Twelve angles, of which the double angle needs that many, and twelve levers.
        grid_size=144,
    )
)
