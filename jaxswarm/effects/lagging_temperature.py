r"""Friction that follows a temperature late: the lubricant warms behind the sensor.

The lubricant's temperature obeys :math:`t_l\,\dot T_l = T - T_l` and starts where the sensor does; friction is
:math:`(a\,\mathrm{sign}\,\dot q + b\,\dot q)(T_l - 25)`, that of ``temperature_friction`` for a sensor in the
lubricant, with a parameter fewer: a lag that is not seen is not named. Told from ``thermal_drift``, which knows
no sensor and falls from the begin of every log. Asked only where logs have a temperature.

Reference: A. C. Bittencourt, S. Gunnarsson, J. Dyn. Sys. Meas. Control 134(5) (2012), section 3 (joint
temperature); J. P. Holman, "Heat Transfer" (2010), section 4-2 (lumped capacity, of first order).
"""

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import Parameter

register(
    TorqueLaw(
        name="lagging_temperature_friction",
        scope="joint",
        parameters=(
            Parameter("a", "N m/K", -100.0, 100.0, True, -0.05, "dry friction per kelvin"),
            Parameter(
                "b", "N m s/(rad K)", -100.0, 100.0, True, -0.02, "viscous friction per kelvin"
            ),
            Parameter(
                "tl", "s", 1.0, 1e4, False, 60.0, "time by which the lubricant follows", "log"
            ),
        ),
        summary="(a sign(dq) + b dq) (Tl - 25 deg C), tl dTl/dt = T - Tl: the lubricant warms late",
        reference="Carvalho Bittencourt, Gunnarsson 2012; Holman 2010, Heat Transfer, sec. 4-2",
        meaning=(
            "Friction changes with a temperature that the sensor says too early; let the compensation "
            "follow the sensor through a filter of this time, or warm the joint up."
        ),
        torque=lambda p, s: (p["a"] * s.direction + p["b"] * s.dq) * (s.state - 25.0),
        rate=lambda p, s: (s.temperature - s.state) / p["tl"],
        start=lambda p, s: s.temperature,
        requires=("temperature",),
        contains=("temperature_friction",),
        uses_direction=True,
        shown_against="time",
        # One time constant: points lie a quarter apart.
        grid_size=32,
    )
)
