r"""A torque that is written down with a share of another joint's.

A torque sensor bends under the moments that a neighbor holds, current sensors of two drives lie side by side:
of the true torques :math:`\tau` of a joint and :math:`\tau_o` of its partner :math:`\tau + c\,\tau_o` is
written down. The partner's is that of the model with all its terms, never the logged one, whose noise would
bias c toward zero. Told from ``transmission_coupling`` and ``cable_coupling``, which bring what the partner's
motion drags along, by all else that the partner's drive supplies: weight, friction, rotor. Where it supplies
nothing but that they say the same, and are undecided. Told from ``drive_gain``, which is a share of the
joint's own torque.

A sensor built against it picks up at most 0.8 % of the moments that its neighbors hold (0.43 of 54.4 N m:
"Design and optimization of a joint torque sensor with small crosstalk error for robots", 2022), others a few
percent; a tenth is the bound here. The couplings of a measured wrist of two motors that drive two joints
together were told as shares of 0.24 and 0.89, and what depends on a joint's load was lost behind them.

Reference: F. Aghili, M. Buehler, J. M. Hollerbach, "Design of a hollow hexaform torque sensor for robot
joints", Int. J. Robotics Research 20(12) (2001) (sensitivity to other moments than the torque).
"""

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.parameter import Parameter

register(
    MeasurementLaw(
        name="torque_crosstalk",
        scope="pair",
        parameters=(Parameter("c", "1", -0.1, 0.1, False, 0.0, "share of the partner's torque"),),
        summary="measured torque = torque + c torque_other: crosstalk of sensors",
        reference="Aghili, Buehler, Hollerbach 2001, Int. J. Robotics Research 20(12)",
        meaning=(
            "The torque of another joint is seen in this one's channel: a sensor that bends under other "
            "moments, or currents measured side by side; calibrate both sensors together."
        ),
        report=lambda p, x, step: x[:, 0] + p["c"] * x[:, 1],
        shown_against="partner torque",
    )
)
