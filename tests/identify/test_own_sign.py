"""The right sign of a channel explains its own joint at least as well as the wrong one."""

import numpy as np
import pytest

from jaxswarm.identify.checks.channels import _believed, _told
from jaxswarm.identify.checks.guess import Guess
from jaxswarm.identify.checks.sound import Tried
from jaxswarm.robot import rx60

LEFT = np.array([0.005, 0.034, 0.108, 0.731])
BRAKING = np.array([0.07, 0.2, 0.2, 0.0])


@pytest.mark.parametrize(("own", "believed"), [(0.97, False), (0.73, True), (0.2, True)])
@pytest.mark.parametrize("check", ["torque_sign", "position_sign"])
def test_a_sign_that_leaves_more_of_its_joint_is_not_believed(check, own, believed):
    """What an unknown law on two joints left as logged, and with the wrong sign of one (0.97)."""
    guess = Guess(check, "", (3,), mixture=np.diag([1.0, 1.0, 1.0, -1.0]))
    found = Tried(np.array([0.005, 0.008, 0.108, own]), BRAKING)
    assert _believed(guess, found, Tried(LEFT, BRAKING), 1.0) == believed


@pytest.mark.parametrize(
    ("left", "drove", "refused"), [(0.43, 0.0, False), (0.43, -0.2, True), (0.1, 0.0, True)]
)
def test_a_sign_beside_which_much_is_left_is_told_and_the_log_goes_on(left, drove, refused):
    """A load as heavy as its last link, picked up and not known, left 48 % of a log, by a wrong sign 43 %."""
    guess = Guess("position_sign", "the position of joint3 has the wrong sign", (2,))
    logged = Tried(np.full(3, 0.48), np.array([0.0, 0.0, drove]))
    finding = _told(rx60(), guess, Tried(np.full(3, left), np.zeros(3)), logged)
    assert finding.refused == refused
    assert ("unless something else" in finding.what) != refused


@pytest.mark.parametrize(("own", "believed"), [(0.45, False), (0.3, True)])
def test_friction_drives_by_more_than_chance_makes_of_what_is_left(own, believed):
    """Of a joint whose load was put down in mid-log 45 % was left, and friction drove it by 12 %."""
    guess = Guess("position_sign", "", (3,))
    logged = Tried(np.array([0.036, 0.076, 0.102, own]), np.array([0.16, 0.0, 0.13, -0.12]))
    found = Tried(np.array([0.039, 0.084, 0.103, own]), np.array([0.14, 0.0, 0.14, 0.11]))
    assert _believed(guess, found, logged, 1.0) == believed
