"""Robots from joints, tables and files: placements, lumping, and what is refused."""

import re

import numpy as np
import pinocchio as pin
import pytest
from random_robots import random_joints, random_state, to_pinocchio, urdf_text

from jaxswarm.errors import InputError
from jaxswarm.robot import (
    BUILTIN_ROBOTS,
    Joint,
    build_robot,
    forward_kinematics,
    inverse_dynamics,
    kuka_kr300,
    kuka_kr300_cad_parameters,
    load_robot,
    robot_from_dh,
    robot_from_urdf,
)
from jaxswarm.robot.placements import rotation_x, rotation_z


@pytest.mark.parametrize("seed", range(4))
def test_urdf_trees_give_the_torques_of_pinocchio(seed):
    text = urdf_text(seed, 6)
    robot = robot_from_urdf(text)
    model = pin.buildModelFromXML(text)
    order = [robot.joints.index(model.names[k]) for k in range(1, model.njoints)]
    q, dq, ddq = random_state(robot, seed)
    config = []
    for joint, k in zip(list(model.joints)[1:], order, strict=True):
        config += [np.cos(q[k]), np.sin(q[k])] if joint.nq == 2 else [q[k]]
    oracle = pin.rnea(model, model.createData(), np.array(config), dq[order], ddq[order])
    tau = np.asarray(inverse_dynamics(robot, q, dq, ddq))[order]
    assert np.abs(tau - oracle).max() < 1e-10 * np.abs(oracle).max()


def test_fixed_links_are_lumped_into_the_link_that_carries_them():
    tool = Joint("tool", "fixed", "j0", rotation_x(0.3), np.array([0.1, 0.2, 0.3]))
    bolted = Joint("plate", "fixed", None, rotation_z(0.4), np.array([0.0, 0.0, 0.5]))
    body = random_joints(0, 2, kinds=("revolute",))
    loaded = Joint(**{**tool.__dict__, "parameters": body[1].parameters})
    lumped = build_robot("arm", [body[0], loaded, bolted])
    assert lumped.joints == ("j0",)
    # The same with the tool on a joint of its own that stands still.
    free = build_robot("arm", [body[0], Joint(**{**loaded.__dict__, "kind": "revolute"})])
    q, dq, ddq = np.array([[0.3], [0.8], [-1.1]])
    still = [np.append(x, 0.0) for x in (q, dq, ddq)]
    expected = inverse_dynamics(free, *still)[0]
    assert abs(inverse_dynamics(lumped, q, dq, ddq)[0] - expected) < 1e-12


def standard_matrix(alpha, a, d, theta):
    turn = rotation_z(theta)
    pose = np.eye(4)
    pose[:3, :3] = turn @ rotation_x(alpha)
    pose[:3, 3] = turn @ [a, 0, 0] + [0, 0, d]
    return pose


def test_standard_table_places_joints_at_the_frame_before():
    table = dict(alpha=[0.3, -1.0, 0.5], a=[0.1, 0.4, 0.0], d=[0.2, 0.0, 0.7])
    theta, q = [0.1, 0.2, -0.4], np.array([0.5, -0.3, 0.9])
    robot = robot_from_dh("arm", convention="standard", theta=theta, **table)
    _, position = forward_kinematics(robot, q)
    pose = np.eye(4)
    for j in range(3):
        np.testing.assert_allclose(position[j], pose[:3, 3], atol=1e-12)
        row = (table["alpha"][j], table["a"][j], table["d"][j], theta[j] + q[j])
        pose = pose @ standard_matrix(*row)


def test_modified_table_with_a_prismatic_joint():
    robot = robot_from_dh(
        "arm",
        convention="modified",
        alpha=[0.3, -1.0],
        a=[0.1, 0.4],
        d=[0.2, 0.5],
        theta=[0.0, 0.7],
        kinds=["revolute", "prismatic"],
    )
    q = np.array([0.4, 0.25])
    rotation, position = forward_kinematics(robot, q)
    first = rotation_x(0.3) @ rotation_z(0.4)
    base = np.array([0.1, 0, 0]) + rotation_x(0.3) @ [0, 0, 0.2]
    tip = base + first @ (np.array([0.4, 0, 0]) + rotation_x(-1.0) @ [0, 0, 0.75])
    np.testing.assert_allclose(position[1], tip, atol=1e-12)
    np.testing.assert_allclose(rotation[1], first @ rotation_x(-1.0) @ rotation_z(0.7), atol=1e-12)


def test_kuka_centers_of_mass_lie_above_the_floor():
    """The base is turned upside down in its table: the published masses must not hang below it."""
    robot = kuka_kr300().replace(parameters=kuka_kr300_cad_parameters())
    home = np.array([0.0, -np.pi / 2, np.pi / 2, 0.0, 0.0, 0.0])
    rotation, position = forward_kinematics(robot, home)
    mass = robot.parameters[:, 0]
    center = robot.parameters[:, 1:4] / mass[:, None]
    height = np.einsum("nj,nj->n", np.asarray(rotation)[:, 2], center) + position[:, 2]
    assert (np.asarray(height) > 0.0).all()
    model = to_pinocchio(robot)
    assert abs(sum(i.mass for i in model.inertias) - mass.sum()) < 1e-9


def test_builtins_name_their_joints_and_gains():
    for name, make in BUILTIN_ROBOTS.items():
        robot = make()
        assert robot.name == name == load_robot(name).name
        known = ["slide"] if name == "emps" else [f"joint{j + 1}" for j in range(robot.num_joints)]
        assert list(robot.joints) == known
        np.testing.assert_allclose(np.linalg.norm(robot.axis, axis=1), 1.0)
    assert BUILTIN_ROBOTS["ur10e"]().drive_gain[0] == 14.87
    assert np.isnan(BUILTIN_ROBOTS["rx60"]().drive_gain).all()


DH_TOML = """
name = "two"
drive_gain = [10, 20]
[dh]
convention = "modified"
alpha = [0, 0]
a = [0, 0.5]
d = [0.1, 0]
"""
JOINT_TOML = """
gravity = [0, 0, -1.62]
[[joint]]
name = "lift"
kind = "prismatic"
[[joint]]
name = "turn"
xyz = [0, 0, 0.3]
rpy = [0, 1.5707963267948966, 0]
axis = [0, 2, 0]
parameters = [1, 0, 0, 0, 1, 0, 1, 0, 0, 1]
"""


def test_toml_tables_and_placements(tmp_path):
    file = tmp_path / "arm.toml"
    file.write_text(DH_TOML)
    robot = load_robot(file)
    assert robot.name == "two" and robot.drive_gain.tolist() == [10.0, 20.0]
    assert robot.translation.tolist() == [[0, 0, 0.1], [0.5, 0, 0]]
    file.write_text(JOINT_TOML)
    robot = load_robot(file)
    assert robot.name == "arm" and robot.kinds == ("prismatic", "revolute")
    assert robot.parents == (-1, 0) and robot.axis[1].tolist() == [0, 1, 0]
    assert robot.gravity[2] == -1.62 and robot.parameters[1, 0] == 1.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("name = ", "not valid TOML"),
        ("[dh]\nalpha=[0]", "lacks convention"),
        ('joints=["a"]\n[dh]\nalpha=[0]', "joints belongs into"),
        ('[dh]\nconvention="standard"\nalpha=[90]\na=[0]\nd=[0]', "alpha has 90, more than a turn"),
        ("grav = [0]", "unknown key 'grav'. Did you mean gravity"),
        (DH_TOML.replace("[0, 0.5]", "[0]"), "column a"),
        (DH_TOML.replace("modified", "modifed"), "Did you mean modified"),
        (DH_TOML.replace("[10, 20]", "[10]"), "drive_gain has 1 entries for 2"),
        (JOINT_TOML.replace("[0, 2, 0]", "[0, 0, 0]"), "is no direction"),
        (JOINT_TOML.replace('"turn"', '"lift"'), "occurs twice"),
        (JOINT_TOML.replace('"prismatic"', '"slider"'), "kind 'slider' is not supported"),
        (
            JOINT_TOML.replace('name = "turn"', 'name = "turn"\nparent = "lfit"'),
            "'lfit' is no joint",
        ),
        (JOINT_TOML.replace("[0, 0, 0.3]", '[0, 0, "x"]'), "3 finite numbers"),
        (DH_TOML + JOINT_TOML.split("\n", 2)[2], "one of the two"),
    ],
)
def test_bad_toml_is_refused_with_the_reason(tmp_path, text, message):
    file = tmp_path / "bad.toml"
    file.write_text(text)
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        load_robot(file)
    assert str(file) in str(caught.value)


URDF = """<robot name="r"><link name="a"/><link name="b"/><gazebo/>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/></joint></robot>"""


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<robot", "not a readable URDF"),
        ("", "not a readable URDF"),
        (URDF.replace('parent link="a"', 'parent link="c"'), "names link 'c'"),
        (URDF.replace("revolute", "floating"), "kind 'floating' is not supported"),
        (URDF.replace("</joint>", '<mimic joint="k"/></joint>'), "no moving joint"),
        (URDF.replace("</joint>", '<axis xyz="0 0 0"/></joint>'), "is no direction"),
        (URDF.replace("revolute", "fixed"), "no moving joint"),
    ],
)
def test_bad_urdf_is_refused_with_the_reason(tmp_path, text, message):
    file = tmp_path / "bad.urdf"
    file.write_text(text)
    with pytest.raises(InputError, match=re.escape(message)):
        load_robot(file)


def test_urdf_without_inertia_gives_kinematics_and_prints_nothing(tmp_path, capfd):
    file = tmp_path / "arm.urdf"
    file.write_text(URDF)
    robot = load_robot(file)
    assert robot.joints == ("j",) and robot.axis.tolist() == [[1, 0, 0]]
    assert not robot.parameters.any()
    captured = capfd.readouterr()
    assert captured.out == captured.err == ""


@pytest.mark.parametrize("spec", ["ur10", "missing.urdf", "missing.toml", "arm.step"])
def test_unknown_robots_are_refused(spec):
    with pytest.raises(InputError, match=re.escape(spec)):
        load_robot(spec)


def test_loops_are_refused():
    with pytest.raises(InputError, match="form a loop"):
        build_robot("loop", [Joint("a", parent="b"), Joint("b", parent="a")])
