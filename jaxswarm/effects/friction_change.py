r"""Dry friction that jumps in the middle of a log: a bearing that gives, grease that arrives.

:math:`f_c\,u(t - t_0)\,\mathrm{sign}(\dot q)` with a smooth step u of a twentieth of a second, so that its
moment has a derivative; outside of that it is exactly zero and one, so that a jump after the log is no column
of tiny numbers. Told from ``thermal_drift``, which falls from the start of the log and does not jump. Where
the joint rests around the jump its moment is known no better than the rest lasts.

Reference: M. Basseville, I. V. Nikiforov, "Detection of Abrupt Changes" (1993), section 2.4 (change of a
regression coefficient at an unknown time).
"""

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import CHANGE, Parameter
from jaxswarm.effects.ramp import ramp

register(
    TorqueLaw(
        name="friction_change",
        scope="joint",
        parameters=(
            Parameter("fc", "N m", -1e4, 1e4, True, 1.0, "dry friction after less that before"),
            CHANGE,
        ),
        summary="fc sign(dq) from the time t0 on: damage, lubrication",
        reference="Basseville, Nikiforov 1993, Detection of Abrupt Changes, sec. 2.4",
        meaning=(
            "Friction jumped in the middle of the log: a bearing or seal that gives, a brake that "
            "drags, grease that arrives; ask what happened at that time and record again."
        ),
        torque=lambda p, s: p["fc"] * ramp(s.t, p["t0"]) * s.direction,
        begins="t0",
        shown_against="time",
        uses_direction=True,
        # Points lie 8 % apart: what a jump explains falls off in proportion to how far it is missed.
        grid_size=128,
    )
)
