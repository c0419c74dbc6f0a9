r"""A zero that wanders: the torque's sensor, or its amplifier, warms up after it was switched on.

:math:`r\,t_c (1 - e^{-t/t_c})` is written down besides: nothing at the begin of every log, then by the rate r,
and :math:`r\,t_c` when the sensor is warm. A log that ends before tells the rate alone. Told from
``torque_offset``, which is there from the first sample on; from ``thermal_drift``, which is friction and turns
with the velocity's sign; from ``offset_change``, a ``contact`` and a load that is picked up
(``payload_change``), which come at once. A joint that hardly turns round does not tell it from friction.

Reference: E. O. Doebelin, "Measurement Systems" (2004), ch. 5 (gages of force and torque, their zero and
temperature); J. P. Holman, "Heat Transfer" (2010), section 4-2 (lumped capacity, of first order).
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import WARMING, Parameter

register(
    TorqueLaw(
        name="offset_drift",
        scope="joint",
        parameters=(
            Parameter("rate", "N m/s", -1e4, 1e4, True, 0.05, "how fast the zero wanders at first"),
            WARMING,
        ),
        summary="rate tc (1 - exp(-t/tc)): the torque's zero wanders",
        reference="Doebelin 2004, Measurement Systems, ch. 5; Holman 2010, Heat Transfer, sec. 4-2",
        meaning=(
            "The zero of the torque's sensor or current wanders while it warms up; switch on and wait before "
            "it is set to zero, or set it to zero again between two recordings."
        ),
        torque=lambda p, s: -p["rate"] * p["tc"] * jnp.expm1(-s.t / p["tc"]),
        # What the zero has moved by in the end.
        derived=lambda p: {"tau": (p["rate"] * p["tc"], "N m")},
        shown_against="time",
    )
)
