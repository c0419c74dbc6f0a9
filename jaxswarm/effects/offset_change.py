r"""A torque whose zero jumps in the middle of a log: a sensor set to zero anew, a hose that is caught.

:math:`\tau\,u(t - t_0)` with the smooth step u of ``friction_change``, from which it is told by standing still
when the velocity turns. Told from ``torque_offset``, which is there from the first sample on, from
``offset_drift``, which comes by and by, from a ``contact``, which is of all joints and ends, and from a load
that is picked up (``payload_change``), which follows the arm's posture.

Reference: M. Basseville, I. V. Nikiforov, "Detection of Abrupt Changes" (1993), section 2.4 (change of a
regression coefficient at an unknown time).
"""

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import CHANGE, Parameter
from jaxswarm.effects.ramp import ramp

register(
    TorqueLaw(
        name="offset_change",
        scope="joint",
        parameters=(
            Parameter("tau", "N m", -1e4, 1e4, True, 0.5, "constant torque after less that before"),
            CHANGE,
        ),
        summary="tau from the time t0 on: the torque's zero jumps",
        reference="Basseville, Nikiforov 1993, Detection of Abrupt Changes, sec. 2.4",
        meaning=(
            "The torque's zero jumped in the middle of the log: a sensor set to zero anew, a hose or cable "
            "that is caught, something hung on the arm; ask what happened at that time and record again."
        ),
        torque=lambda p, s: p["tau"] * ramp(s.t, p["t0"]),
        begins="t0",
        shown_against="time",
        # As friction_change: what a jump explains falls off in proportion to how far it is missed.
        grid_size=128,
    )
)
