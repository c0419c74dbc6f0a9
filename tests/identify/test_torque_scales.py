"""Torques of motors before their gears are told with the scale that leaves least."""

from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.identify.checks.check_log import against_robot
from jaxswarm.logs.motion import Filtering
from jaxswarm.logs.segments import prepare_segments


def found(arm, log):
    bare = arm.replace(parameters=np.zeros((6, 10)))  # masses alone would tell the unit
    return against_robot(bare, prepare_segments(log, Filtering(torque_cutoff=5.0))[1])


@pytest.mark.parametrize("gear", [30.0, 160.0])
def test_a_gear_between_powers_of_ten_is_told(arm, log, gear):
    finding, *_ = found(arm, replace(log, tau=log.tau / np.array([1, 1, gear, 1, 1, 1])))
    assert finding.check == "torque_scale" and finding.refused
    told = finding.what.removeprefix("the torque of joint3 is ").split(" times")[0]
    assert float(told) == pytest.approx(gear, rel=0.15)


def test_scales_of_several_torques_are_told_at_once(arm, log):
    scales = np.array([1.0, 1.0, 1.0, 40.0, 9.0, 0.1])
    finding, *_ = found(arm, replace(log, tau=log.tau / scales))
    assert finding.check == "torque_scale" and "and all times one number" in finding.what
    told = finding.what.split("about ")[1].split(", and all")[0].split(", ")
    ratio = np.array([float(one.split()[1]) for one in told]) / scales
    np.testing.assert_allclose(ratio[:5] / ratio[0], 1.0, rtol=0.4)
