r"""A zero that wanders: the torque's sensor, or its amplifier, warms up after it was switched on.

:math:`\tau_\infty (1 - e^{-t/t_c})` is written down besides: nothing at the begin of every log, the whole of it
when the sensor is warm. Told from ``torque_offset``, which is there from the first sample on; from
``thermal_drift``, which is friction and turns with the velocity's sign; from a load that is picked up
(``payload_change``) and a ``contact``, which come at once. A joint that hardly turns round does not tell it
from friction.

Reference: E. O. Doebelin, "Measurement Systems" (2004), ch. 5 (gages of force and torque, their zero and
temperature); J. P. Holman, "Heat Transfer" (2010), section 4-2 (lumped capacity, of first order).
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import Parameter

register(
    TorqueLaw(
        name="offset_drift",
        scope="joint",
        parameters=(
            Parameter("tau", "N m", -1e4, 1e4, True, 0.5, "what the zero has moved by in the end"),
            Parameter("tc", "s", 1.0, 1e4, False, 30.0, "time constant of warming", "log"),
        ),
        summary="tau (1 - exp(-t/tc)): the torque's zero wanders",
        reference="Doebelin 2004, Measurement Systems, ch. 5; Holman 2010, Heat Transfer, sec. 4-2",
        meaning=(
            "The zero of the torque's sensor or current wanders while it warms up; switch on and wait before "
            "it is set to zero, or set it to zero again between two recordings."
        ),
        torque=lambda p, s: -p["tau"] * jnp.expm1(-s.t / p["tc"]),
        # A sensor that warms for longer than the log shows how fast its zero wanders, not where it ends.
        derived=lambda p: {"rate": (p["tau"] / p["tc"], "N m/s")},
        shown_against="time",
    )
)
