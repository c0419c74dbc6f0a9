"""Other joints of which a wrong channel explains a log as well are named once each."""

from small_problems import planar_arm

from jaxswarm.identify.checks.channels import _with_rivals
from jaxswarm.identify.checks.guesses import zero_guess


def test_a_joint_that_a_rough_and_a_fine_model_bear_out_is_named_once():
    robot = planar_arm()
    own, other = zero_guess(robot, 0, -0.23), zero_guess(robot, 1, 0.3)
    told = _with_rivals(robot, own, [own, other, other, own]).what
    assert told.endswith(f"(or that of {robot.joints[1]})")
