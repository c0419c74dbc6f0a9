"""MJCF through MuJoCo: the torques of its inverse dynamics, and what is told of the rest."""

import sys

import mujoco
import numpy as np
import pytest

from jaxswarm.effects.advice import with_effects
from jaxswarm.errors import InputError
from jaxswarm.robot import describe_robot, inverse_dynamics, load_robot, parse_options

ARM = """
<mujoco model="arm">
  <compiler angle="degree" eulerseq="zyx" autolimits="true"/>
  <option gravity="0.5 -1 -9"/>
  <default>
    <joint axis="0 1 0" armature="0.3"/>
    <default class="slider"><joint type="slide" axis="0 0.6 0.8" armature="0" ref="0.1"/>
      <default class="short"><joint range="-0.2 0.3"/></default></default>
  </default>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="stand" pos="0 0 0.5" euler="10 20 30">
      <inertial pos="0 0 0" mass="4" diaginertia="1 1 1"/>
      <body name="shoulder" pos="0 0.1 0.2">
        <joint name="pan" axis="0 0 1" pos="0.1 0 0" range="-90 90" damping="2"/>
        <joint name="tilt" pos="0 0 0.05" ref="30"/>
        <inertial pos="0.1 0 0.2" quat="0.8 0.6 0 0" mass="3" diaginertia="0.03 0.02 0.02"/>
        <body name="bracket" pos="0.2 0 0"><inertial pos="0 0 0" mass="1"
            fullinertia="0.02 0.03 0.04 0.001 0.002 0.003"/>
          <body name="rail" pos="0.3 0 0" axisangle="1 0 0 40">
            <joint name="reach" class="short" pos="0 0.2 0"/>
            <geom type="capsule" size="0.04 0.2" mass="1.5"/>
            <body name="jaw"><joint name="jaw" class="slider"/>
              <inertial pos="0 0.1 0" mass="0.2" diaginertia="0.001 0.001 0.001"/></body>
          </body>
        </body>
      </body>
      <body name="other"><joint axis="1 1 0" springref="0" stiffness="3"/>
        <inertial pos="0 0 0.1" mass="0.4" diaginertia="0.01 0.01 0.01"/></body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / "arm.xml"
        path.write_text(text)
        return path

    return write


def mujoco_torques(text, q, dq, ddq, names, robot):
    """Inverse dynamics of MuJoCo without what is told in notes: rotors, dampers, springs."""
    model = mujoco.MjModel.from_xml_string(text)
    for array in (model.dof_armature, model.dof_damping, model.jnt_stiffness):
        array[:] = 0.0
    model.opt.disableflags = (
        mujoco.mjtDisableBit.mjDSBL_CONSTRAINT | mujoco.mjtDisableBit.mjDSBL_CONTACT
    )
    data = mujoco.MjData(model)
    order = [robot.joints.index(name) for name in names]
    data.qpos, data.qvel, data.qacc = q[order], dq[order], ddq[order]
    mujoco.mj_inverse(model, data)
    return data.qfrc_inverse, order


@pytest.mark.parametrize("seed", range(3))
def test_torques_equal_mujoco(file, seed):
    robot = load_robot(file(ARM))
    assert robot.name == "arm" and robot.gravity.tolist() == [0.5, -1.0, -9.0]
    q, dq, ddq = np.random.default_rng(seed).normal(size=(3, robot.num_joints))
    names = ["pan", "tilt", "reach", "jaw", "other_joint4"]
    oracle, order = mujoco_torques(ARM, q, dq, ddq, names, robot)
    tau = np.asarray(inverse_dynamics(robot, q, dq, ddq))[order]
    assert np.abs(tau - oracle).max() < 1e-9 * np.abs(oracle).max()


def test_what_is_no_part_of_the_links_is_told(file):
    notes = " | ".join(with_effects(load_robot(file(ARM)).notes))
    assert "armature is not part of the links (pan 0.3, tilt 0.3" in notes
    assert "damping is not part of the links (pan 2): declare viscous_friction" in notes
    assert "stiffness is not part of the links (other_joint4): declare joint_spring" in notes


def test_limits_are_read_in_radians(file):
    limits = {joint.name: joint.limits for joint in describe_robot(file(ARM)).joints}
    np.testing.assert_allclose(limits["pan"][:2], np.deg2rad([-90, 90]))
    assert limits["reach"][:2] == (-0.2, 0.3) and np.isnan(limits["tilt"].lower)


def test_equalities_couple_joints_as_mimics_do(file):
    """Joint at c0 + c1 times the other, both from their reference positions, which are 0.1 here."""
    pair = '<joint joint1="jaw" joint2="reach" polycoef="0.02 -1 0 0 0"/>'
    text = ARM.replace("</mujoco>", f"<equality>{pair}</equality></mujoco>")
    model = mujoco.MjModel.from_xml_string(text)
    robot = load_robot(file(text), parse_options(lock="reach=0.25"))
    assert robot.joints == ("pan", "tilt", "other_joint4")
    data = mujoco.MjData(model)
    at = next(n for n in robot.notes if "'jaw' follows" in n).rsplit(" ", 1)[1]
    data.qpos[2:4] = 0.25, float(at)
    mujoco.mj_forward(model, data)
    assert abs(data.efc_pos[data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY][0]) < 1e-12
    weld = '<equality><weld body1="jaw" body2="other"/></equality></mujoco>'
    robot = load_robot(file(ARM.replace("</mujoco>", weld)))
    assert any("weld" in note and "not modeled" in note for note in robot.notes)


def test_free_and_ball_joints_are_refused_and_can_be_locked(file):
    for kind in ("free", "ball"):
        joint = f'<joint name="odd" type="{kind}" armature="0"/><inertial pos="0 0 0" mass="4"'
        inner = ARM.replace('<inertial pos="0 0 0" mass="4"', joint)
        path = file(inner)
        with pytest.raises(InputError, match="--lock odd"):
            load_robot(path)
        assert load_robot(path, parse_options(lock="odd")).num_joints == 5


def test_damaged_files_and_a_missing_package_are_told(file, monkeypatch):
    with pytest.raises(InputError, match="MuJoCo refuses it"):
        load_robot(file(ARM.replace('type="slide"', 'type="slid"')))
    with pytest.raises(InputError, match="document type"):
        load_robot(file("<!DOCTYPE x><mujoco/>"))
    with pytest.raises(InputError, match="no moving joint"):
        load_robot(file("<mujoco><worldbody/></mujoco>"))
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(InputError, match=r"pip install 'jaxswarm\[mjcf\]'"):
        load_robot(file(ARM))


def test_warnings_of_mujoco_are_notes_and_leave_no_file(file, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    path = file(ARM.replace('springref="0"', 'springref="nan"'))
    (told,) = [n for n in describe_robot(path).notes if "MuJoCo warns" in n]
    assert "NaN" in told
    assert [p.name for p in tmp_path.iterdir()] == [path.name]
    assert capfd.readouterr() == ("", "")
