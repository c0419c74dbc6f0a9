r"""A spring mechanism that carries the weight of an arm: a coil or gas spring on a lever.

A spring between a point of the link at radius r and one of the base at distance d from the axis has the
length :math:`L = \sqrt{r^2 + d^2}\,\sqrt{1 + b \cos x}`, with x the angle from where the three points are in
line and :math:`b = 2 r d/(r^2 + d^2)`. A gas spring of constant force gives
:math:`c \sin x / \sqrt{1 + b \cos x}`, one whose force goes with the projection of the lever
:math:`a \sin 2x / \sqrt{1 + b \cos x}`; the sine that is left of a coil spring is taken up by the weight.
Turning q0 by half a turn changes the sign of b and c, so that b is positive. Told from ``joint_spring``
and ``cubic_spring`` by a motion over more than a radian.

Reference: V. Arakelian, "Gravity compensation in robotics", Advanced Robotics 30(2) (2016), eqs. 5-9.
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import Parameter


def _lever(p, s):
    x = s.q - p["q0"]
    return (p["a"] * jnp.sin(2.0 * x) + p["c"] * jnp.sin(x)) / jnp.sqrt(1.0 + p["b"] * jnp.cos(x))


register(
    TorqueLaw(
        name="gravity_compensator",
        scope="joint",
        parameters=(
            Parameter("a", "N m", -1e5, 1e5, True, 10.0, "of the double angle"),
            Parameter("c", "N m", -1e5, 1e5, True, 0.0, "of the single angle: constant force"),
            Parameter("b", "1", 0.02, 0.98, False, 0.3, "2 r d/(r^2 + d^2) of the lever"),
            Parameter("q0", "rad", -3.15, 3.15, False, 0.0, "where the lever is in line"),
        ),
        summary="(a sin(2x) + c sin(x)) / sqrt(1 + b cos(x)), x = q - q0: spring on a lever",
        reference="Arakelian 2016, Advanced Robotics 30(2)",
        torque=_lever,
        shown_against="position",
        # Eight angles and eight levers.
        grid_size=64,
    )
)
