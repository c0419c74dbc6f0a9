"""Exported arms reloaded: the torques and motions of MuJoCo and Pinocchio are ours."""

import json

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pinocchio as pin
import pytest

from jaxswarm.errors import InputError
from jaxswarm.identify.physical.export import export_mjcf, export_sdf, export_urdf
from jaxswarm.identify.physical.export_parts import quaternion, roll_pitch_yaw
from jaxswarm.robot import Joint, build_robot, inverse_dynamics, load_robot, rx60
from jaxswarm.robot.placements import body_parameters, rotation_rpy
from jaxswarm.simulate import Acting, make_plant, rest, simulate, stable_substeps

NUM = 3


def random_arm(seed):
    rng = np.random.default_rng(seed)
    joints = []
    for j in range(NUM):
        spread = rng.normal(size=(3, 3))
        second = spread @ spread.T * 0.03
        inertia = np.trace(second) * np.eye(3) - second
        joints.append(
            Joint(
                f"j{j}",
                kind="prismatic" if j == 2 else "revolute",
                parent=f"j{rng.integers(max(j - 2, 0), j)}" if j else None,
                rotation=rotation_rpy(rng.uniform(-3, 3, 3)),
                translation=rng.normal(size=3) * 0.3,
                axis=rng.normal(size=3),
                parameters=body_parameters(rng.uniform(1, 4), rng.normal(size=3) * 0.1, inertia),
            )
        )
    return build_robot("arm", joints)


EFFECTS = [
    *(Acting("viscous_friction", j, values={"b": 0.5 + j}) for j in range(NUM)),
    *(Acting("rotor_inertia", j, values={"ia": 0.2 + 0.1 * j}) for j in range(NUM)),
    Acting("joint_spring", 2, values={"k": 40.0, "tau0": -3.0}),
    Acting("torque_offset", 0, values={"tau0": 0.7}),
]


@pytest.fixture(scope="module")
def arm():
    return random_arm(3)


def test_urdf_gives_the_torques_of_pinocchio_and_comes_back(arm, tmp_path):
    path = tmp_path / "arm.urdf"
    side = export_urdf(arm, path, EFFECTS)
    model = pin.buildModelFromUrdf(str(path))
    q, dq, ddq = np.random.default_rng(0).normal(size=(3, NUM))
    order = [arm.joints.index(model.names[k]) for k in range(1, model.njoints)]
    config = []
    for joint, k in zip(list(model.joints)[1:], order, strict=True):
        config += [np.cos(q[k]), np.sin(q[k])] if joint.nq == 2 else [q[k]]
    oracle = pin.rnea(model, model.createData(), np.array(config), dq[order], ddq[order])
    tau = np.asarray(inverse_dynamics(arm, q, dq, ddq))
    np.testing.assert_allclose(tau[order], oracle, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(model.damping, [0.5 + k for k in order])
    back = load_robot(path)
    np.testing.assert_allclose(back.parameters, arm.parameters, atol=1e-12)
    left = json.loads(side.read_text())["not_in_file"]
    names = {entry["effect"] for entry in left}
    assert names == {"rotor_inertia", "joint_spring", "torque_offset"}


def test_mjcf_gives_the_torques_of_mujoco(arm, tmp_path):
    path = tmp_path / "arm.xml"
    side = export_mjcf(arm, path, EFFECTS)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    q, dq, ddq = np.random.default_rng(1).normal(size=(3, NUM))
    order = [model.joint(name).id for name in arm.joints]
    data.qpos[order], data.qvel[order], data.qacc[order] = q, dq, ddq
    mujoco.mj_inverse(model, data)
    tau = np.array(inverse_dynamics(arm, q, dq, ddq))
    tau += (0.2 + 0.1 * np.arange(NUM)) * ddq + (0.5 + np.arange(NUM)) * dq
    tau[2] += 40.0 * q[2] - 3.0
    np.testing.assert_allclose(data.qfrc_inverse[order], tau, rtol=1e-9, atol=1e-9)
    left = json.loads(side.read_text())["not_in_file"]
    assert [entry["effect"] for entry in left] == ["torque_offset"]


def test_sdf_comes_back_and_keeps_what_drake_reads(arm, tmp_path):
    path = tmp_path / "arm.sdf"
    side = export_sdf(arm, path, EFFECTS)
    back = load_robot(path)
    q, dq, ddq = np.random.default_rng(2).normal(size=(3, NUM))
    order = [arm.joints.index(joint) for joint in back.joints]
    tau = np.asarray(inverse_dynamics(arm, q, dq, ddq))
    mine = inverse_dynamics(back.replace(gravity=arm.gravity), q[order], dq[order], ddq[order])
    np.testing.assert_allclose(mine, tau[order], rtol=1e-10, atol=1e-10)
    left = json.loads(side.read_text())["not_in_file"]
    assert [entry["effect"] for entry in left] == ["torque_offset"]
    text = path.read_text()
    assert text.count("<drake:rotor_inertia>") == NUM and "<spring_stiffness>40<" in text


@pytest.mark.parametrize("kind", ["urdf", "sdf"])
def test_drake_reads_what_is_written(arm, kind, tmp_path):
    """Bodies and damping, and from SDF springs and rotors too."""
    multibody = pytest.importorskip("pydrake.multibody.all")
    path = tmp_path / f"arm.{kind}"
    {"urdf": export_urdf, "sdf": export_sdf}[kind](arm, path, EFFECTS)
    plant = multibody.MultibodyPlant(0.0)
    multibody.Parser(plant).AddModels(str(path))
    if kind == "urdf":  # its base is a link of its own
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base"))
    plant.mutable_gravity_field().set_gravity_vector(np.asarray(arm.gravity))
    plant.Finalize()
    context = plant.CreateDefaultContext()
    order = [plant.GetJointByName(name).velocity_start() for name in arm.joints]
    q, dq, ddq = np.random.default_rng(3).normal(size=(3, NUM))

    def torque(q, dq, ddq):
        own = np.zeros((3, NUM))
        own[:, order] = q, dq, ddq
        plant.SetPositions(context, own[0])
        plant.SetVelocities(context, own[1])
        forces = multibody.MultibodyForces(plant)
        plant.CalcForceElementsContribution(context, forces)
        return plant.CalcInverseDynamics(context, own[2], forces)[order]

    wanted = inverse_dynamics(arm, q, dq, ddq) + (0.5 + np.arange(NUM)) * dq
    wanted = np.array(wanted)
    if kind == "sdf":
        wanted += (0.2 + 0.1 * np.arange(NUM)) * ddq
        wanted[2] += 40.0 * q[2] - 3.0
    np.testing.assert_allclose(torque(q, dq, ddq), wanted, rtol=1e-9, atol=1e-9)


def test_motion_equals_mujoco_with_armature_damping_spring_and_dry_friction(arm, tmp_path):
    """Without dry friction to 1e-8 of the span; dry friction, a soft constraint there and a smooth
    sign here, to 1 mrad."""
    dt, num = 1e-3, 300
    tau = np.array([8.0, -5.0, 20.0])

    def effects(friction):
        dry = [Acting("coulomb_friction", j, values={"fc": friction}) for j in range(NUM)]
        return [*EFFECTS[:-1], *dry]

    def plant(friction):
        return make_plant(arm, effects(friction), width=5e-3)

    steps = stable_substeps(plant(0.8), jnp.zeros(NUM), dt)
    drive = jnp.tile(tau, (num, 1))
    run = jax.jit(lambda p: simulate(p, rest(p, jnp.zeros(NUM)), drive, dt=dt, substeps=steps))
    for friction in (0.0, 0.8):
        path = tmp_path / "arm.xml"
        export_mjcf(arm, path, effects(friction))
        model = mujoco.MjModel.from_xml_path(str(path))
        model.opt.timestep = dt
        data = mujoco.MjData(model)
        order = [model.joint(name).id for name in arm.joints]
        data.ctrl[order] = tau
        oracle = []
        for _ in range(num):
            oracle.append(data.qpos[order].copy())
            mujoco.mj_step(model, data)
        motion = run(plant(friction))
        span = np.ptp(oracle, axis=0)
        assert span.max() > 0.3
        error = np.abs(motion.q - np.array(oracle)).max(0)
        assert (error < (1e-3 if friction else 1e-8 * np.maximum(span, 1.0))).all()


def test_bodies_that_cannot_be_are_refused_and_nothing_is_written(tmp_path):
    path = tmp_path / "rx60.urdf"
    for export in (export_urdf, export_mjcf):
        with pytest.raises(InputError, match="link 3"):
            export(rx60(), path)
    assert not list(tmp_path.iterdir())


def test_negative_friction_stays_in_the_side_file(arm, tmp_path):
    effect = Acting("viscous_friction", 0, values={"b": -0.1})
    side = export_urdf(arm, tmp_path / "arm.urdf", [effect])
    assert json.loads(side.read_text())["not_in_file"][0]["values"] == {"b": -0.1}


@pytest.mark.parametrize("pitch", [0.3, np.pi / 2, -np.pi / 2])
def test_rotations_come_back_from_angles_and_quaternions(pitch):
    rotation = rotation_rpy([2.9, pitch, -1.2])
    np.testing.assert_allclose(rotation_rpy(roll_pitch_yaw(rotation)), rotation, atol=1e-12)
    w, *v = quaternion(rotation)
    cross = np.cross(np.eye(3), v)
    rebuilt = np.eye(3) + 2 * w * cross + 2 * cross @ cross
    np.testing.assert_allclose(rebuilt, rotation, atol=1e-12)
