"""Exported models reloaded by our reader, Pinocchio, MuJoCo, a YAML reader and a C compiler."""

import ctypes
import shutil
import subprocess
from dataclasses import replace

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pinocchio as pin
import pytest
import yaml

from jaxswarm.effects import REGISTRY, Sample, TorqueLaw
from jaxswarm.effects.term import Term
from jaxswarm.errors import InputError
from jaxswarm.identify.estimation.base_parameters import find_base
from jaxswarm.identify.forward.model import Model
from jaxswarm.identify.physical.export_c import c_text
from jaxswarm.identify.physical.physical_model import physical_model, random_columns
from jaxswarm.logs.motion import Filtering
from jaxswarm.robot import inverse_dynamics, load_robot, standard_parameter_names
from jaxswarm.robot.placements import body_parameters
from jaxswarm.simulate.forces import own_memory
from jaxswarm.tasks import export

WIDTH = (0.02, 0.01, 0.05)


def base_model(scale=1.0):
    """The rx60 with bodies, as an identification gives it: base values, zeros for what merges."""
    arm = load_robot("rx60")
    rng = np.random.default_rng(4)
    rows = []
    for _ in range(3):
        spread = rng.normal(size=(3, 3)) * 0.2
        second = spread @ spread.T
        inertia = np.trace(second) * np.eye(3) - second
        rows.append(body_parameters(rng.uniform(3, 9), rng.normal(size=3) * 0.1, inertia))
    theta = np.array(rows).ravel()
    base = find_base(random_columns(arm).reshape(-1, 30), standard_parameter_names(arm))
    values = base.reduce(theta)
    # An inertia about its own axis below zero is what noise can give: no bodies have it.
    full = base.expand(values * np.where(np.array(base.names)[base.kept] == "Izz3", scale, 1.0))
    arm = arm.replace(parameters=jnp.asarray(full.reshape(3, 10)))
    terms = tuple(Term("viscous_friction", j, values={"b": 1.0 + j}) for j in range(3))
    return Model(arm, terms, WIDTH, Filtering(10.0, 8.0), (0.1, 0.1, 0.1))


@pytest.fixture(scope="module")
def model():
    return base_model()


def states(seed=0):
    return np.random.default_rng(seed).normal(size=(3, 3))


def test_urdf_of_base_parameters_keeps_the_torque(model, tmp_path):
    result = export(model, tmp_path / "arm.urdf")
    assert max(result["moved"]["rms"]) < 1e-3
    back = load_robot(tmp_path / "arm.urdf").replace(gravity=model.robot.gravity)
    q, dq, ddq = states()
    wanted = np.asarray(inverse_dynamics(model.robot, q, dq, ddq))
    np.testing.assert_allclose(inverse_dynamics(back, q, dq, ddq), wanted, atol=2e-3)
    arm = pin.buildModelFromUrdf(str(tmp_path / "arm.urdf"))
    arm.gravity.linear = np.asarray(model.robot.gravity)
    turned = np.stack([np.cos(q), np.sin(q)], axis=1).ravel()
    np.testing.assert_allclose(pin.rnea(arm, arm.createData(), turned, dq, ddq), wanted, atol=2e-3)


def test_sdf_of_base_parameters_keeps_the_torque(model, tmp_path):
    export(model, tmp_path / "arm.sdf")
    back = load_robot(tmp_path / "arm.sdf").replace(gravity=model.robot.gravity)
    q, dq, ddq = states(5)
    wanted = np.asarray(inverse_dynamics(model.robot, q, dq, ddq))
    np.testing.assert_allclose(inverse_dynamics(back, q, dq, ddq), wanted, atol=2e-3)


def test_mjcf_in_mujoco(model, tmp_path):
    export(model, tmp_path / "arm.xml")
    arm = mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml"))
    data = mujoco.MjData(arm)
    q, dq, ddq = states(1)
    data.qpos[:], data.qvel[:], data.qacc[:] = q, dq, ddq
    mujoco.mj_inverse(arm, data)
    wanted = np.asarray(inverse_dynamics(model.robot, q, dq, ddq)) + (1.0 + np.arange(3)) * dq
    np.testing.assert_allclose(data.qfrc_inverse, wanted, atol=2e-3)


def test_yaml_builds_the_arm_in_pinocchio(model, tmp_path):
    export(model, tmp_path / "arm.yaml")
    read = yaml.safe_load((tmp_path / "arm.yaml").read_text())
    arm = pin.Model()
    arm.gravity.linear = np.array(read["gravity"])
    index = {None: 0}
    for joint in read["joints"]:
        place = pin.SE3(np.array(joint["rotation"]), np.array(joint["translation"]))
        kind = pin.JointModelRevoluteUnaligned(np.array(joint["axis"]))
        index[joint["name"]] = arm.addJoint(index[joint["parent"]], kind, place, joint["name"])
        body = pin.Inertia.FromDynamicParameters(np.array(joint["parameters"]))
        arm.appendBodyToJoint(index[joint["name"]], body, pin.SE3.Identity())
    q, dq, ddq = states(2)
    tau = pin.rnea(arm, arm.createData(), q, dq, ddq)
    np.testing.assert_allclose(tau, inverse_dynamics(model.robot, q, dq, ddq), atol=2e-3)
    assert read["effects"][1]["joint"] == "joint2" and read["effects"][1]["values"] == {"b": 2.0}
    assert read["sign_width"] == list(WIDTH)


def test_what_no_bodies_have_is_told(tmp_path):
    result = export(base_model(-0.5), tmp_path / "arm.urdf")
    assert max(result["moved"]["rms"]) > 0.1
    assert "torque moves by" in repr(result)


def test_a_prior_of_another_robot_and_unknown_formats_are_refused(model, tmp_path):
    with pytest.raises(InputError, match="has joints"):
        export(model, tmp_path / "arm.urdf", prior="ur10e")
    with pytest.raises(InputError, match="mjcf"):
        export(model, tmp_path / "arm.urdf", "mjfc")
    with pytest.raises(InputError, match="names no format"):
        export(model, tmp_path / "arm")
    assert not list(tmp_path.iterdir())


def test_a_prior_is_kept_where_the_torque_leaves_freedom(model):
    plain = physical_model(model)
    heavy = physical_model(
        model, prior=model.robot.replace(parameters=plain.model.robot.parameters.at[0, 0].set(40.0))
    )
    assert float(heavy.model.robot.parameters[0, 0]) == pytest.approx(40.0, rel=0.01)
    np.testing.assert_allclose(heavy.moved, 0.0, atol=1e-3)


def compiled(text, folder):
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("no C compiler")
    source, library = folder / "effects.c", folder / "effects.so"
    source.write_text(text)
    flags = ["-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", "-O1"]
    subprocess.run([compiler, *flags, str(source), "-o", str(library), "-lm"], check=True)
    return ctypes.CDLL(str(library))


def seen(law) -> dict[str, float]:
    """The usual values of a law, with something in the place of zeros that its torque is linear in."""
    return {**law.nominal(), **{p.name: p.nominal or 0.7 for p in law.linear}}


def test_every_law_is_the_same_in_c(tmp_path):
    """One file with all laws that add a torque, against the laws themselves at random states."""
    arm = load_robot("rx60")
    rng = np.random.default_rng(0)
    laws = [law for law in REGISTRY.values() if isinstance(law, TorqueLaw)]
    terms = [
        Term(law.name, k % 3, (k + 1) % 3 if law.scope == "pair" else None, seen(law))
        for k, law in enumerate(laws)
    ]
    function = compiled(c_text(arm, terms, WIDTH), tmp_path).rx60_effects
    assert len(terms) >= 12
    memories = [term for term in terms if term.law.rate is not None]
    for _ in range(5):
        t, given = rng.uniform(0, 5), rng.normal(size=(6, 3))
        given[5] += 25.0
        state = rng.uniform(-1.0, 1.0, sum(term.law.memories for term in memories))
        entries = iter(state)
        tau, rate = np.zeros(3), np.zeros(len(state))
        pointers = [
            x.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for x in (*given, state, tau, rate)
        ]
        function(ctypes.c_double(t), *pointers)
        q, dq, ddq, load, static, warm = given
        wanted, rates = np.zeros(3), []
        for term in terms:
            j, o = term.joint, term.other
            other = (0.0, 0.0) if o is None else (dq[o], ddq[o])
            mine = own_memory(term.law, entries) if term in memories else 0.0
            sample = Sample(
                t, q[j], dq[j], ddq[j], np.tanh(dq[j] / WIDTH[j]), load[j], static[j], warm[j],
                *other, np.tanh((dq[j] + other[0]) / WIDTH[j]),
                np.tanh((dq[j] - other[0]) / WIDTH[j]), mine, 0.0 if o is None else q[o],
            )  # fmt: skip
            sample = jax.tree.map(jnp.asarray, sample)
            wanted[j] += float(term.law.torque(term.values, sample))
            if term in memories:
                rates += jax.tree.leaves(term.law.rate(term.values, sample))
        np.testing.assert_allclose(tau, wanted, rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(rate[: len(rates)], rates, rtol=1e-12)


def test_what_a_file_does_not_hold_is_told_by_name(model, tmp_path):
    more = (
        Term("coulomb_friction", 0, values={"fc": 2.0}),
        Term("rotor_inertia", 1, values={"ia": 0.3}),
        Term("torque_ripple", 1, values={"sine": 0.5, "cosine": 0.1, "n": 20.0}),
        Term("base_tilt", values={"gx": 0.1, "gy": 0.0}),
    )
    richer = replace(model, terms=(*model.terms, *more))
    left = {
        name: export(richer, tmp_path / f"arm.{name}", log=None)["not_in_file"]
        for name in ("urdf", "xml", "sdf", "yaml", "c")
    }
    ripple = "torque_ripple@joint2"
    assert left == {
        **{"urdf": ["rotor_inertia@joint2", ripple, "base_tilt"], "xml": [ripple, "base_tilt"]},
        **{"sdf": [ripple, "base_tilt"], "yaml": [], "c": ["base_tilt"]},
    }
    told = repr(export(richer, tmp_path / "arm.sdf"))
    assert "not in the file: torque_ripple on joint2; base_tilt" in told
    assert "Drake passes the file's dry friction over" in told
    assert "Gazebo passes the file's rotor inertia over" in told
    assert "Pinocchio" in repr(export(model, tmp_path / "arm.urdf"))


def test_c_tells_what_it_leaves_out():
    arm = load_robot("rx60")
    text = c_text(arm, [Term("base_tilt", values={"gx": 0.1, "gy": 0.0})], WIDTH)
    assert "not in this file: base_tilt" in text
