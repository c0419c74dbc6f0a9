"""URDF as people have it, and the options of a robot, against Pinocchio."""

import re
import shlex

import numpy as np
import pinocchio as pin
import pytest
from robot_files import FOREIGN, TREE, gripper_arm

from jaxswarm.errors import InputError
from jaxswarm.robot import (
    RobotChoice,
    RobotOptions,
    describe_robot,
    gravity_forces,
    inverse_dynamics,
    load_robot,
    parse_options,
    robot_from_urdf,
)


def pinocchio_torques(text, robot, locked, seed=0, gravity=None, tool=None):
    """Torques of both for one state, with joints held at positions in Pinocchio's own way."""
    model = pin.buildModelFromXML(text)
    if gravity is not None:
        model.gravity.linear = np.array(gravity)
    full = pin.neutral(model)
    for name, value in locked.items():
        full[model.joints[model.getJointId(name)].idx_q] = value
    model = pin.buildReducedModel(model, [model.getJointId(name) for name in locked], full)
    if tool is not None:
        name, mass, center = tool
        body = pin.Inertia(mass, np.array(center), np.zeros((3, 3)))
        model.appendBodyToJoint(model.getJointId(name), body, pin.SE3.Identity())
    order = [robot.joints.index(model.names[k]) for k in range(1, model.njoints)]
    assert sorted(order) == list(range(robot.num_joints))
    q, dq, ddq = np.random.default_rng(seed).normal(size=(3, robot.num_joints))
    config = []
    for joint, k in zip(list(model.joints)[1:], order, strict=True):
        config += [np.cos(q[k]), np.sin(q[k])] if joint.nq == 2 else [q[k]]
    oracle = pin.rnea(model, model.createData(), np.array(config), dq[order], ddq[order])
    return np.asarray(inverse_dynamics(robot, q, dq, ddq))[order], oracle


def assert_equal(pair):
    np.testing.assert_allclose(*pair, rtol=1e-9, atol=1e-9)


@pytest.fixture
def arm(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(gripper_arm())
    return path


def test_a_tree_with_a_slide_gives_the_torques_of_pinocchio():
    assert_equal(pinocchio_torques(TREE, robot_from_urdf(TREE), {}))


def test_what_does_not_concern_dynamics_is_passed_over_and_told():
    robot = robot_from_urdf(gripper_arm(FOREIGN))
    plain = robot_from_urdf(gripper_arm())
    np.testing.assert_array_equal(robot.parameters, plain.parameters)
    told = "not read: 1 <drake:diagonal>, 1 <transmission>, 1 <gazebo>"
    assert told in robot.notes and told not in plain.notes


def test_a_mimicking_joint_is_locked_where_its_master_puts_it(arm):
    robot = load_robot(arm)
    assert robot.joints == (*(f"j{j}" for j in range(1, 8)), "finger1")
    assert any("'finger2' follows 'finger1'" in note for note in robot.notes)
    assert_equal(pinocchio_torques(gripper_arm(), robot, {"finger2": 0.01}))
    held = load_robot(arm, RobotOptions(lock=(("finger1", 0.03),)))
    assert_equal(pinocchio_torques(gripper_arm(), held, {"finger1": 0.03, "finger2": -0.02}))
    own = load_robot(arm, RobotOptions(lock=(("finger2", 0.02),)))
    assert_equal(pinocchio_torques(gripper_arm(), own, {"finger2": 0.02}))
    free = load_robot(arm, RobotOptions(joints=("j1", "finger2")))
    assert free.joints == ("j1", "finger2")


def test_the_chain_of_interest_carries_what_is_locked(arm):
    chain = RobotOptions(joints=("j2", "j4", "j5"), lock=(("j3", 0.7), ("j1", -0.4)))
    robot = load_robot(arm, chain)
    assert robot.joints == ("j2", "j4", "j5")
    locked = {"j1": -0.4, "j3": 0.7, "j6": 0.0, "j7": 0.0, "finger1": 0.0, "finger2": 0.01}
    assert_equal(pinocchio_torques(gripper_arm(), robot, locked))
    assert "joint 'j3' is locked at 0.7" in robot.notes


def test_tool_and_gravity(arm):
    options = parse_options("j1,j2,j3", None, "2.5,0.1,0,0.2", "0,9.81,0")
    robot = load_robot(RobotChoice(str(arm), options))
    others = {f"j{j}": 0.0 for j in range(4, 8)} | {"finger1": 0.0, "finger2": 0.01}
    tool = ("j3", 2.5, [0.1, 0.0, 0.2])
    pair = pinocchio_torques(gripper_arm(), robot, others, 1, [0.0, 9.81, 0.0], tool)
    assert_equal(pair)
    spinning = load_robot("emps", parse_options(tool="2,0,0,0,1,0,2,0,0,3"))
    np.testing.assert_array_equal(spinning.parameters[0], [2, 0, 0, 0, 1, 0, 2, 0, 0, 3])


def test_options_apply_to_built_in_robots_and_keep_their_drive_gains():
    robot = load_robot("ur10e", RobotOptions(joints=("joint2", "joint3")))
    assert robot.drive_gain.tolist() == [13.26, 11.13]
    whole = load_robot("ur10e")
    np.testing.assert_array_equal(gravity_forces(whole, np.ones(6)), np.zeros(6))


def test_floating_joints_are_refused_and_can_be_locked(tmp_path):
    path = tmp_path / "float.urdf"
    text = TREE.replace('name="left_joint" type="revolute"', 'name="left_joint" type="floating"')
    path.write_text(text)
    with pytest.raises(InputError, match="--lock left_joint"):
        load_robot(path)
    robot = load_robot(path, parse_options(lock="left_joint"))
    assert robot.joints == ("left_wrist", "right_joint", "right_slide")
    with pytest.raises(InputError, match="is floating: it can be locked where the file places it"):
        load_robot(path, parse_options(lock="left_joint=0.5"))


@pytest.mark.parametrize(
    ("texts", "message"),
    [
        ({"joints": "j1,j8"}, "no moving joint 'j8'"),
        ({"lock": "flange"}, "no moving joint 'flange'"),
        ({"lock": "j1=a"}, "not 1 finite numbers"),
        ({"lock": "j1=nan"}, "not 1 finite numbers"),
        ({"joints": "j1", "lock": "j1"}, "drop it from one"),
        ({"joints": "j1,,j2"}, "give joint names"),
        ({"joints": ""}, "give joint names"),
        ({"tool": "1,2"}, "not 4 or 10 finite numbers"),
        ({"tool": "-1,0,0,0", "joints": "j1"}, "below zero"),
        ({"gravity": "0,0,inf"}, "not 3 finite numbers"),
    ],
)
def test_bad_options_are_refused(arm, texts, message):
    with pytest.raises(InputError, match=message):
        load_robot(arm, parse_options(**texts))


def test_a_tool_needs_one_last_link(tmp_path):
    path = tmp_path / "tree.urdf"
    path.write_text(TREE)
    with pytest.raises(InputError, match="2 last links .left_wrist, right_slide."):
        load_robot(path, parse_options(tool="1,0,0,0"))


def test_mimics_that_lead_nowhere():
    """A master that is not there leaves the joint at its offset, and is told; a circle is refused."""
    text = gripper_arm().replace('mimic joint="finger1"', 'mimic joint="nobody"')
    robot = robot_from_urdf(text)
    assert (
        "joint 'finger2' follows 'nobody' and is locked at 0.01: 'nobody' is no moving joint"
        in (robot.notes)
    )
    with pytest.raises(InputError, match="mimics itself"):
        robot_from_urdf(text.replace("nobody", "finger2"))


def test_xacro_gets_the_command_that_expands_it(tmp_path):
    path = tmp_path / "my arms" / "arm.urdf.xacro"
    path.parent.mkdir()
    path.write_text(gripper_arm('<xacro:include filename="$(find hands)/hand.xacro"/>'))
    with pytest.raises(InputError) as told:
        load_robot(path)
    command = re.search(r"expand it first: (xacro .*) \(package xacro", str(told.value))[1]
    assert shlex.split(command) == ["xacro", str(path), ">", "arm.urdf"]
    assert "it takes files of hands" in str(told.value)
    path.write_text(gripper_arm().replace('value="2.0"', 'value="${m}"'))
    with pytest.raises(InputError, match="is a xacro template"):
        load_robot(path)


def test_limits_are_read_and_damaged_ones_told():
    path = gripper_arm().replace('lower="-2.5" upper="2.5" effort="80"', 'lower="x"', 1)
    robot = robot_from_urdf(path)
    assert any("limits not read" in note and "lower" in note for note in robot.notes)


def test_description_holds_limits(arm):
    limits = {joint.name: joint.limits for joint in describe_robot(arm).joints}
    assert limits["j1"] == (-2.5, 2.5, 2.0, 80.0)
