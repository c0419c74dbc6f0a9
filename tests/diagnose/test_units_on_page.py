"""Numbers and axes of a report: no noise of rounding, no sign of zero, units of the joint."""

from types import SimpleNamespace

import numpy as np
import pytest

from jaxswarm.diagnose.report import grids
from jaxswarm.diagnose.report.shown import evidence_axis
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs.motion import Filtering
from jaxswarm.robot import load_robot


def test_rounding_in_the_standard_parameters_is_nothing():
    inertia = [[0.2, 2e-26, -0.0], [2e-26, 0.3, -1e-4], [-0.0, -1e-4, 0.4]]
    link = {"joint": "slide", "possible": True, "mass": 20.0, "center": [-2.6e-25, 0.0, 0.01]}
    told = {"physical_consistency": {"links": [{**link, "inertia": inertia}]}}
    (cells,) = grids.standard_parameters(told).rows
    assert cells == ("slide", "20", "0", "0", "0.01", "0.2", "0.3", "0.4", "0", "0", "-0.0001")


@pytest.mark.parametrize(
    ("robot", "effect", "unit"),
    [
        ("emps", "joint_spring", "[m]"),
        ("emps", "viscous_friction", "[m/s]"),
        ("emps", "rotor_inertia", "[m/s^2]"),
        ("rx60", "joint_spring", "[rad]"),
        ("rx60", "viscous_friction", "[rad/s]"),
    ],
)
def test_the_axis_of_a_picture_has_the_unit_of_its_joint(robot, effect, unit):
    arm = load_robot(robot)
    n = arm.num_joints
    rows = np.zeros((3, n))
    motion = SimpleNamespace(joints=arm.joints, t=rows[:, 0], q=rows, dq=rows, ddq=rows)
    model = Model(arm, (), (0.01,) * n, Filtering(), (1.0,) * n)
    label, values = evidence_axis(Term(effect, 0), model, motion)
    assert label.endswith(f"of {arm.joints[0]} {unit}") and values.shape == (3,)
