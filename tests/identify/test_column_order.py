"""Columns of all joints in another order are told, with the joints that they are of."""

from dataclasses import replace

import pytest

from jaxswarm.identify.checks.check_log import against_robot
from jaxswarm.logs.motion import Filtering
from jaxswarm.logs.segments import prepare_segments

ORDERS = {
    (5, 4, 3, 2, 1, 0): "from the last joint to the first",
    (2, 1, 0, 3, 4, 5): "they are those of joint3, joint2, joint1, joint4, joint5, joint6",
    (3, 5, 2, 4, 0, 1): "they are those of joint4, joint6, joint3, joint5, joint1, joint2",
}


def found(arm, log):
    return against_robot(arm, prepare_segments(log, Filtering(torque_cutoff=5.0))[1])


@pytest.mark.parametrize("order", ORDERS)
def test_the_order_of_all_columns_is_told(arm, log, order):
    rows = list(order)
    finding, *_ = found(arm, replace(log, q=log.q[:, rows], tau=log.tau[:, rows]))
    assert finding.check == "swapped_channels" and finding.refused
    assert finding.what.startswith("positions and torques are ") and ORDERS[order] in finding.what


def test_joints_sorted_by_their_names_are_told(arm, log):
    names = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
    named = replace(arm, joints=names)
    rows = sorted(range(6), key=names.__getitem__)
    finding, *_ = found(named, replace(log, q=log.q[:, rows], tau=log.tau[:, rows]))
    assert ", ".join(sorted(names)) in finding.what
