"""The worlds of the benchmark: MuJoCo against Pinocchio, effects against their laws, draws repeated."""

import json
from dataclasses import replace
from types import SimpleNamespace

import mujoco
import numpy as np
import pinocchio
import pytest

from benchmarks.worlds import plain, strength
from benchmarks.worlds.along import declared_torque, effect_torques, view
from benchmarks.worlds.arm import mjcf, pin_model, toml, urdf
from benchmarks.worlds.bodies import across, askew, carried, loaded
from benchmarks.worlds.control import Control
from benchmarks.worlds.edit import edit_oracle, without
from benchmarks.worlds.families import draw_arm, joint_scales
from benchmarks.worlds.files import write_world
from benchmarks.worlds.intervals import true_values
from benchmarks.worlds.laws import IN_BODY, INSIDE, LAWS, OUTSIDE, STRUCTURAL, Effect, torque_of
from benchmarks.worlds.motion import FAMILIES, Motion, reference
from benchmarks.worlds.place import place_effect
from benchmarks.worlds.plan import CLEAN, ROUND, plan
from benchmarks.worlds.reading import said
from benchmarks.worlds.record import measured_torque
from benchmarks.worlds.rigid import Absorber, declared_columns, inverse_dynamics, rms
from benchmarks.worlds.score import _load as read_logs
from benchmarks.worlds.simulate import simulate
from benchmarks.worlds.strength import Ground, size_effect, thin
from benchmarks.worlds.world import make_world
from jaxswarm.robot.load import load_robot

FRICTION = ("viscous_friction", "coulomb_friction")


@pytest.mark.parametrize("seed", range(6))
def test_mujoco_and_pinocchio_agree_on_every_arm(seed):
    arm = draw_arm(np.random.default_rng(seed))
    model = mujoco.MjModel.from_xml_string(mjcf(arm, 1e-3))
    data = mujoco.MjData(model)
    rigid = pin_model(arm)
    rng = np.random.default_rng(0)
    for _ in range(3):
        data.qpos[:], data.qvel[:], data.qacc[:] = rng.normal(size=(3, arm.size))
        mujoco.mj_inverse(model, data)
        torque = pinocchio.rnea(rigid, rigid.createData(), data.qpos, data.qvel, data.qacc)
        np.testing.assert_allclose(
            data.qfrc_inverse, torque + arm.rotor * data.qacc, rtol=1e-8, atol=1e-9
        )


@pytest.mark.parametrize("write, name", [(toml, "arm.toml"), (urdf, "arm.urdf")])
def test_the_written_robot_has_the_same_kinematics(write, name, tmp_path):
    for seed in range(4):
        arm = draw_arm(np.random.default_rng(seed))
        (tmp_path / name).write_text(write(arm))
        robot = load_robot(str(tmp_path / name))
        assert robot.joints == arm.joints and robot.kinds == arm.kinds
        np.testing.assert_allclose(robot.rotation, arm.rotation, atol=1e-12)
        np.testing.assert_allclose(robot.translation, arm.xyz, atol=1e-12)
        np.testing.assert_allclose(robot.axis, arm.axis, atol=1e-12)


def test_a_soft_joint_divides_the_arm_into_motor_and_link():
    """With the deflection held, motor and link together are the rigid arm."""
    arm = draw_arm(np.random.default_rng(2))
    soft = mujoco.MjModel.from_xml_string(mjcf(arm, 1e-3, soft=(1,)))
    data = mujoco.MjData(soft)
    motor = np.array([0, 1, *range(3, arm.size + 1)])
    rng = np.random.default_rng(0)
    q, dq, ddq = rng.normal(size=(3, arm.size))
    data.qpos[motor], data.qvel[motor], data.qacc[motor] = q, dq, ddq
    mujoco.mj_inverse(soft, data)
    rigid = pin_model(arm)
    torque = pinocchio.rnea(rigid, rigid.createData(), q, dq, ddq)
    np.testing.assert_allclose(data.qfrc_inverse[motor], torque + arm.rotor * ddq, rtol=1e-8)
    np.testing.assert_allclose(data.qfrc_inverse[2], torque[1], rtol=1e-8)


def _small_arm():
    """Three joints of drawn make, with friction whose sign a millisecond can follow."""
    for seed in range(100):
        arm = draw_arm(np.random.default_rng(seed))
        if arm.size == 3 and not arm.sliding.any():
            return replace(arm, width=np.full(3, 0.02))
    raise AssertionError("no arm of three turning joints among a hundred")


ARM = _small_arm()
CONTROL = Control("pd", 1000, 3, 25.0)
MOTION = Motion("fourier", 5, 3.0)


def _run(*effects, motion=MOTION, arm=ARM):
    compliance = joint_scales(arm)[0] - arm.rotor
    return simulate(arm, effects, CONTROL, motion, np.full(3, 1e-9), compliance)


def _effect(kind):
    """A tenth of the joint's usual torque, or for a structure a plain example."""
    rng = np.random.default_rng(1)
    effect = place_effect(rng, ARM, kind)
    scale = 0.1 * float(joint_scales(ARM)[1].min())
    params = {
        k: v * (scale if k in LAWS[kind].scaled else 1.0)
        for k, v in effect.params.items()
        if k != "tau"
    }
    if kind == "contact":
        params = {"start": 1.0, "end": 1.5, "tau": [scale, -scale, scale]}
    if kind == "friction_change":
        params["start"] = 1.5
    return replace(effect, params=params)


TORQUES = [k for k in LAWS if k not in STRUCTURAL]


@pytest.mark.parametrize("kind", TORQUES)
def test_an_effect_adds_the_torque_its_law_states(kind):
    """Motor torque less bodies, friction and rotors (Pinocchio) is the law along the measured motion."""
    effect = _effect(kind)
    run = _run(effect)
    rest = run.tau - declared_torque(ARM, run)
    stated = np.zeros_like(rest)
    if kind == "load_dependent_friction":  # the load is that of the bodies alone
        assert rms(run.parts[0]).max() > 0
    for joint, (dry, smooth) in torque_of(effect, view(ARM, run, effect)).items():
        stated[:, joint] = dry * np.tanh(run.dq[:, joint] / ARM.width[joint]) + smooth
    size = rms(stated).max()
    assert size > 0
    lasting = slice(1000, None)  # a bristle forgets where it was before the log within a second
    assert rms((rest - stated)[lasting]).max() < 0.03 * size + 2e-4 * rms(run.tau).max()


@pytest.mark.parametrize("held", [True, False])
def test_dry_friction_that_holds_gives_any_torque_within_it_at_rest(held):
    """In motion it is the declared one; at rest joints hardly creep, at torques that no sign tells."""
    arm = replace(ARM, held=held, coulomb=0.2 * joint_scales(ARM)[1])
    run = _run(motion=Motion("ptp", 5, 6.0), arm=arm)
    off = np.abs(run.tau - declared_torque(arm, run)) / arm.coulomb
    fast, slow = np.abs(run.dq) > 5.0 * arm.width, np.abs(run.dq) < 0.2 * arm.width
    assert fast.any(axis=0).all() and (slow.mean(axis=0) > 0.1).all()
    assert np.quantile(off[fast], 0.99) < 1e-3
    for own, rows in zip(off.T, slow.T, strict=True):
        assert (
            0.5 < np.median(own[rows]) < own[rows].max() < 1.0 if held else own[rows].max() < 0.01
        )


def test_a_structure_does_what_it_says():
    """Gain and delay act on the measured torque alone; tilt, offset, softness and backlash the motion."""
    plain_run = _run()
    gain = Effect("drive_gain", 1, params={"gain": 1.1})
    np.testing.assert_allclose(
        measured_torque(plain_run, (gain,))[:, 1], 1.1 * plain_run.tau[:, 1], rtol=1e-12
    )
    delay = Effect("time_delay", params={"seconds": 0.01})
    late = measured_torque(plain_run, (delay,))
    np.testing.assert_allclose(late[500], plain_run.tau[490], rtol=1e-9)
    tilt = Effect("base_tilt", params={"gx": 0.5, "gy": -0.3})
    run = _run(tilt)
    gravity = np.array([0.5, -0.3, -np.sqrt(9.81**2 - 0.34)])
    model = pin_model(ARM, gravity)
    data = model.createData()
    rows = [
        pinocchio.rnea(model, data, *x).copy() for x in zip(run.q, run.dq, run.ddq, strict=True)
    ]
    friction = ARM.viscous * run.dq + ARM.coulomb * np.tanh(run.dq / ARM.width)
    rest = run.tau - np.array(rows) - ARM.rotor * run.ddq - friction
    assert rms(rest).max() < 1e-3 * rms(run.tau).max()


def test_a_load_is_carried_between_its_times_and_no_longer():
    load = {"m": 1.0, "x": 0.05, "y": -0.03, "z": 0.08, "start": 1.0, "end": 2.0}
    effect = Effect("payload_change", params=load)
    run = _run(effect)
    more = inverse_dynamics(loaded(ARM, effect), run.q, run.dq, run.ddq)
    more -= inverse_dynamics(ARM, run.q, run.dq, run.ddq)
    stated = more * carried(effect, run.t)[:, None]
    rest = run.tau - declared_torque(ARM, run)
    settled = np.abs(run.t[:, None] - [1.0, 2.0]).min(axis=1) > 0.2
    assert rms((rest - stated)[settled]).max() < 0.03 * rms(stated).max()


def test_a_joint_askew_turns_the_weight_of_what_it_carries():
    effect = Effect("link_geometry", 1, params={"shift": 0.01, "turn": 0.05})
    run, built = _run(effect), askew(ARM, (effect,))
    direction = across(ARM, 1)
    np.testing.assert_allclose(built.xyz[1] - ARM.xyz[1], 0.01 * direction)
    assert np.trace(built.rotation[1] @ ARM.rotation[1].T) == pytest.approx(1 + 2 * np.cos(0.05))
    rest = run.tau - declared_torque(ARM, run)
    stated = inverse_dynamics(built, run.q, run.dq, run.ddq)
    stated -= inverse_dynamics(ARM, run.q, run.dq, run.ddq)
    lasting = slice(500, None)
    assert (
        rms((rest - stated)[lasting]).max() < 0.03 * rms(stated).max() + 2e-4 * rms(run.tau).max()
    )


@pytest.mark.parametrize("kind", ["encoder_eccentricity", "gear_coupling_error"])
def test_a_wrong_encoder_says_a_motion_and_its_derivatives(kind):
    effect = _effect(kind)
    run = _run(effect)
    inner = slice(100, -100)
    for x, slope in ((run.q, run.dq), (run.dq, run.ddq)):
        told = plain.low_pass(np.gradient(x, run.t, axis=0), 1000.0, 20.0)[inner]
        assert rms(told - plain.low_pass(slope, 1000.0, 20.0)[inner]).max() < 0.02 * rms(told).max()
    true = said((replace(effect, params={k: -v for k, v in effect.params.items()}),), *_said(run))
    motor = replace(run, q=true[0], dq=true[1], ddq=true[2])
    left = run.tau - declared_torque(ARM, motor)
    apart = run.tau - declared_torque(ARM, run)
    j = effect.joint
    assert rms(left[500:])[j] < 0.3 * rms(apart[500:])[j]


def _said(run):
    return run.q, run.dq, run.ddq


def test_drives_bend_and_filter_the_measured_torque_alone():
    run = _run()
    bend = Effect("torque_constant_saturation", 1, params={"c": 0.01})
    band = Effect("torque_dead_band", 1, params={"d": 0.5})
    tau = run.tau[:, 1]
    told = [measured_torque(run, (e,))[:, 1] for e in (bend, band)]
    np.testing.assert_allclose(told[0], tau * (1.0 - 0.01 * np.abs(tau)), rtol=1e-12)
    np.testing.assert_allclose(told[1], tau + 0.5 * np.sign(tau), rtol=1e-12)
    slow = measured_torque(run, (Effect("torque_lag", params={"tc": 0.02}),))[:, 1]
    rate = np.gradient(slow, run.t)
    rest = plain.low_pass((slow + 0.02 * rate - tau)[:, None], 1000.0, 10.0)[500:-500]
    assert rms(rest).max() < 0.02 * rms(tau[:, None]).max()


def test_softness_moves_the_torque_by_what_the_link_lags():
    """On slow motion a soft joint's motor feels the load of the link at the motor's angle less load / k."""
    k = 500.0 * float(joint_scales(ARM)[1].max())
    effect = Effect("joint_elasticity", 1, params={"k": k, "d": 0.002 * k})
    run = _run(effect)
    data = pin_model(ARM).createData()
    model = pin_model(ARM)
    found = effect_torques(ARM, run, (effect,))[0]
    load = np.array(
        [pinocchio.rnea(model, data, *x).copy() for x in zip(run.q, run.dq, run.ddq, strict=True)]
    )
    lag = np.zeros_like(run.q)
    lag[:, 1] = plain.low_pass(load[:, 1], 1000.0, 10.0) / k
    moved = [run.q - lag]
    for x in (run.dq, run.ddq):
        lag = np.gradient(lag, run.t, axis=0)
        moved.append(x - lag)
    stated = (
        np.array([pinocchio.rnea(model, data, *x).copy() for x in zip(*moved, strict=True)]) - load
    )
    slow = slice(500, -500)
    a, b = plain.low_pass(found, 1000.0, 5.0)[slow], plain.low_pass(stated, 1000.0, 5.0)[slow]
    assert rms(a - b).max() < 0.3 * rms(b).max()


def test_play_lets_the_link_go_by_the_gap_and_no_more():
    gap = 0.01
    run, tight = _run(Effect("backlash", 1, params={"gap": gap})), _run()
    change = rms(run.tau - tight.tau)[1]
    assert change > 1e-3 * rms(tight.tau)[1]


def test_absorber_takes_up_what_its_columns_span_and_nothing_else():
    run = _run()
    declared = tuple((e, j) for e in FRICTION for j in range(3))
    columns = declared_columns(ARM, declared, run.q[::5], run.dq[::5], run.ddq[::5])
    absorber = Absorber(columns, np.ones(3))
    values = np.random.default_rng(0).normal(size=columns.shape[2])
    np.testing.assert_allclose(absorber.left(columns @ values), 0.0, atol=1e-7)
    noise = np.random.default_rng(1).normal(size=columns.shape[:2])
    assert rms(absorber.left(noise)).min() > 0.9


@pytest.mark.parametrize("kind", ["quadratic_drag", "torque_ripple", "joint_spring", "base_tilt"])
def test_a_wanted_strength_is_reached(kind):
    """What the declared model leaves of the run with the sized effect is the wanted multiple of the unit."""
    declared = tuple((e, j) for e in FRICTION for j in range(3))
    noise = np.array([0.1, 0.05, 0.02])
    rich = Motion("ptp", 2, 8.0)
    clean = thin(_run(motion=rich))

    def absorber(run):
        return Absorber(declared_columns(ARM, declared, run.q, run.dq, run.ddq), noise)

    ground = Ground(ARM, clean, absorber(clean), noise)
    effect = size_effect(place_effect(np.random.default_rng(1), ARM, kind), 4.0, ground)
    run = thin(_run(effect, motion=rich))
    left = absorber(run).left(measured_torque(run, (effect,)))
    assert (rms(left) / noise).max() == pytest.approx(4.0, rel=0.25)


def test_a_world_is_the_same_world_every_time_and_its_files_say_what_it_is(tmp_path):
    worlds = make_world(47), make_world(47)
    logs = [w.log("train", w.runs["train"])[0] for w in worlds]
    for key in logs[0]:
        np.testing.assert_array_equal(logs[0][key], logs[1][key])
    truth = write_world(worlds[0], tmp_path)
    assert [e["effect"] for e in truth["effects"]] == ["backlash"] and truth["declared"]
    assert json.loads((tmp_path / "truth.json").read_text()) == truth
    test = np.load(tmp_path / "test_ptp.npz")
    assert {"t", "q", "tau", "tau_clean", "tau_effect"} <= set(test.files)
    noise = rms(test["tau"] - test["tau_clean"])
    assert (noise < 1.5 * np.array(truth["noise"])).all() and (noise > 0).all()


def test_the_plan_holds_all_kinds_and_500_clean_worlds():
    plans = [plan(k, np.random.default_rng([20261, k])) for k in range(100 * ROUND)]
    assert sum(not p.kinds and not p.common for p in plans) == 100 * CLEAN
    assert {k for p in plans for k in p.kinds} == set(INSIDE) | set(OUTSIDE)
    for p in plans:
        assert sum(k in STRUCTURAL for k in p.kinds) <= 1
        assert not set(p.kinds) & set(IN_BODY) or p.declared != "friction and rotors"


@pytest.mark.parametrize("family", FAMILIES)
def test_references_are_their_own_derivatives_within_the_limits(family):
    t = np.arange(-1.0, 8.0, 1e-3)
    q, dq, ddq = reference(Motion(family, 3, 8.0), ARM, t)
    np.testing.assert_allclose(np.gradient(q, t, axis=0), dq, atol=2e-2 * np.abs(dq).max())
    assert rms(np.gradient(dq, t, axis=0) - ddq).max() < 5e-2 * rms(ddq).max()
    for x, limit in ((q, ARM.reach), (dq, ARM.speed), (ddq, ARM.acceleration)):
        assert (np.abs(x) <= 1.01 * limit).all()


def test_dry_friction_that_a_law_takes_from_is_told_where_nothing_is_declared():
    """World 895: a drift takes from friction that was raised for its sake, and the truth has to say so."""
    world = make_world(895, longest=3.0)
    assert not world.arm.coulomb.any() and not world.declared
    drift = next(e for e in world.effects if e.kind == "thermal_drift")
    dry = [e for e in world.effects if (e.kind, e.joint) == ("coulomb_friction", drift.joint)]
    assert len(dry) == 1 and dry[0].params["fc"] > drift.params["fc"]


def test_true_dry_friction_is_all_there_is_on_the_joint():
    """A law that takes of it needs some: what the arm has besides the effect is told together with it."""
    world = SimpleNamespace(arm=SimpleNamespace(coulomb=np.array([0.0, 2.5])))
    effect = Effect("coulomb_friction", 1, params={"fc": 0.5})
    assert true_values(effect, world) == {"fc": 3.0}


def test_the_oracle_of_the_edit_test_loses_the_effect_and_keeps_the_rest(tmp_path):
    """What is left without a faint effect is a small part of it: its numbers were fitted beside the arm's."""
    world = make_world(5)
    write_world(world, tmp_path)
    logs = {name: read_logs(tmp_path, name) for name in ("train", "edit_ptp")}
    joint = world.edited.joint
    effect = rms(np.load(tmp_path / "test_ptp.npz")["tau_effect"])[joint]
    assert 0.0 < edit_oracle(world, logs)[joint] < 0.25 * effect


def test_deleting_friction_that_differs_by_direction_leaves_what_was_declared():
    values = {"fc_pos": 3.0, "fc_neg": 2.0, "b_pos": 1.5, "b_neg": 1.0}
    left = without({"effect": "asymmetric_friction", "values": values})
    assert left["values"] == {"fc_pos": 2.0, "fc_neg": 2.0, "b_pos": 1.0, "b_neg": 1.0}
    assert without({"effect": "joint_spring", "values": {"k": 1.0}}) is None


@pytest.mark.parametrize(("seconds", "told"), [(0.0038, True), (0.0041, False)])
def test_a_delay_below_half_a_sample_is_one_of_the_clocks(seconds, told):
    """Every fit allows for it, and none names it: that was counted as missed."""
    assert strength._of_clocks(Effect("time_delay", params={"seconds": seconds}), 125.0) is told
    assert not strength._of_clocks(Effect("torque_lag", params={"tc": seconds}), 125.0)
