r"""A number of the geometry that is wrong: a link longer than drawn, an axis out of square.

A joint sits on its parent shifted by millimeters or turned by degrees. Shifts along its own axis and turns
about it are taken up by the link or are a wrong zero of its encoder; those about the parent's axis are a
wrong zero of the parent's, so that two shifts and one turn (two on parallel axes) remain. Told from
``encoder_offset``, of one parameter, and from ``base_tilt``, which acts before the first joint.

The torque is that of the moved arm itself: to first order a turn of 0.1 rad left so much of an arm of six
joints that a false friction was told of it, with three to eight times the error on other motion. How a shift
along the parent link changes the weight on the parent goes by a mass that no log of the one arm tells from the
parent's own first moment.

Reference: J. Hollerbach, W. Khalil, M. Gautier, "Model identification", Springer Handbook of Robotics (2016),
ch. 6.2 (kinematic calibration).
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.parameter import Parameter

register(
    BodyChange(
        name="link_geometry",
        scope="joint",
        parameters=(
            Parameter(
                "x", "m", -0.2, 0.2, False, 0.0, "shift across the parent's axis and its own"
            ),
            Parameter("y", "m", -0.2, 0.2, False, 0.0, "shift across its own axis and that of x"),
            Parameter("turn_x", "1", -0.3, 0.3, False, 0.0, "turn about the direction of x [rad]"),
            Parameter("turn_y", "1", -0.3, 0.3, False, 0.0, "turn about that of y, parallel axes"),
        ),
        summary="a joint sits shifted by x, y and turned by turn_x, turn_y on its parent",
        reference="Hollerbach, Khalil, Gautier 2016, Springer Handbook of Robotics, ch. 6",
        meaning=(
            "A length or an angle between two joints is not what the model says: another variant of "
            "the arm, a spacer, a bent link; measure it, or calibrate the kinematics."
        ),
        placement=lambda p: jnp.array([[p["x"], p["y"]], [p["turn_x"], p["turn_y"]]]),
        carried=True,
        min_joints=2,
        shown_against="position",
    )
)
