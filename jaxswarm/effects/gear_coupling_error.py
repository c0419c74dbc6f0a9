r"""A wrist whose drives run through each other, with a wrong ratio in the controller.

The motor of one joint is turned along by another; the controller takes that off by a ratio. Where the ratio is
wrong by c, the joint stands at :math:`q + c\,q_o` while :math:`q` is logged. Told from
``transmission_coupling``, which adds torques of the coupled motors and leaves positions as they are, and from
``encoder_offset``, to which it comes down where the partner hardly moves.

References: D. E. Whitney, C. A. Lozinski, J. M. Rourke, "Industrial robot forward calibration method and
results", ASME J. Dyn. Sys. Meas. Control 108(1) (1986) (coupling of wrist joints); R. P. Judd,
A. B. Knasinski, IEEE Trans. Robotics Automation 6(1) (1990).
"""

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.parameter import Parameter

register(
    MeasurementLaw(
        name="gear_coupling_error",
        scope="pair",
        parameters=(
            Parameter("c", "1", -0.5, 0.5, False, 0.0, "turn of the joint per turn of the partner"),
        ),
        summary="true position = measured position + c q_other: wrong coupling ratio",
        reference="Whitney, Lozinski, Rourke 1986, ASME J. Dyn. Sys. Meas. Control 108(1)",
        meaning=(
            "The joint is turned along by its partner more or less than the controller takes off; "
            "check the coupling ratio of the two in the controller."
        ),
        excess=lambda p, q, q_other: -p["c"] * q_other,
        shown_against="partner position",
    )
)
