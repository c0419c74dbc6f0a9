"""A scale of a position is no mistake of the log where a mere zero explains more of its joint."""

import numpy as np
import pytest

from jaxswarm.identify.checks.channels import _bends
from jaxswarm.identify.checks.guesses import motion_scale_guesses, zero_guess
from jaxswarm.identify.checks.sound import Tried
from jaxswarm.robot import load_robot


@pytest.mark.parametrize(("zero", "bent"), [(0.046, True), (0.07, False)])
def test_a_scale_bends_where_a_zero_leaves_less_of_its_joint(zero, bent):
    """The figures of a last joint that turned with another one."""
    arm = load_robot("ur10e")
    (half,) = (g for g in motion_scale_guesses(arm) if g.joints == (5,) and g.factor == 0.5)

    def leaves(last):
        return Tried(np.array([0.04, 0.01, 0.02, 0.01, 0.04, last]), np.zeros(6))

    tried = [(half, leaves(0.06)), (zero_guess(arm, 4, 0.37), leaves(zero))]
    assert _bends(*tried[0], tried) is bent
    assert not _bends(*tried[1], tried)
