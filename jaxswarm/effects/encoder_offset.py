r"""An encoder whose zero is wrong by a constant: a robot not calibrated, or put together anew.

Every position of the joint is off, so that geometry, gravity and all couplings change. What the joint itself
carries is turned with it and taken up by its first moments; the links beyond feel another direction of gravity,
and it is in their torques that the error shows. It cannot be seen on a first joint that turns about the
vertical, nor on a last one. Joints with parallel axes in a row (shoulder, elbow and first wrist of many arms)
say nearly the same and are told apart by the masses between them only: rivals are named. Told from
``base_tilt``, whose direction stays where it is when the first joint turns.

Reference: J. Hollerbach, W. Khalil, M. Gautier, "Model identification", Springer Handbook of Robotics (2016),
ch. 6.2 (joint offsets of kinematic calibration).
"""

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.parameter import Parameter

register(
    MeasurementLaw(
        name="encoder_offset",
        scope="joint",
        parameters=(Parameter("dq0", "rad", -0.5, 0.5, False, 0.0, "measured less true position"),),
        summary="measured position = position + dq0: wrong zero of an encoder",
        reference="Hollerbach, Khalil, Gautier 2016, Springer Handbook of Robotics, ch. 6",
        meaning=(
            "The zero of the encoder is off, as after an exchange of motor, belt or battery: the arm "
            "stands elsewhere than it says; set the zero anew by its marks."
        ),
        excess=lambda p, q, q_other: p["dq0"] + 0.0 * q,
        min_joints=2,
        shown_against="position",
    )
)
