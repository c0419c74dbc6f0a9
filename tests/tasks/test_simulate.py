"""Simulated models against MuJoCo, which knows none of our code."""

import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from jaxswarm import log_from_arrays, simulate
from jaxswarm.effects.term import Term
from jaxswarm.errors import InputError
from jaxswarm.identify.estimation.base_parameters import find_base
from jaxswarm.identify.forward.model import Model
from jaxswarm.identify.physical.export import export_mjcf
from jaxswarm.identify.physical.physical_model import random_columns
from jaxswarm.logs.motion import Filtering
from jaxswarm.robot import load_robot, standard_parameter_names
from jaxswarm.robot.placements import body_parameters

KP, KD = np.array([300.0, 300.0, 60.0]), np.array([30.0, 30.0, 3.0])


def arm():
    """The rx60 with bodies for links."""
    bodies = [
        body_parameters(m, np.array(c), np.diag(i))
        for m, c, i in (
            (6.0, (0.0, 0.02, 0.1), (0.08, 0.07, 0.04)),
            (4.0, (0.14, 0.01, 0.03), (0.02, 0.06, 0.07)),
            (3.0, (0.02, 0.05, 0.1), (0.05, 0.04, 0.02)),
        )
    ]
    return load_robot("rx60").replace(parameters=jnp.asarray(bodies))


def model_of(robot, terms=()):
    """What an identification holds: base values, zeros elsewhere."""
    base = find_base(random_columns(robot).reshape(-1, 30), standard_parameter_names(robot))
    full = base.expand(base.reduce(np.asarray(robot.parameters).ravel()))
    robot = robot.replace(parameters=jnp.asarray(full.reshape(3, 10)))
    return Model(robot, tuple(terms), (0.01,) * 3, Filtering(), (0.1, 0.1, 0.1))


VISCOUS = [Term("viscous_friction", j, values={"b": 2.0 + j}) for j in range(3)]


def reference(length=601, step=0.002):
    t = np.arange(length) * step
    q = 0.4 * np.sin(2 * np.pi * 0.5 * t[:, None] + np.arange(3)) + np.array([0.0, 0.5, -0.3])
    return log_from_arrays(t, q, require_torque=False)


def test_a_controlled_arm_moves_as_in_mujoco(tmp_path):
    robot, target = arm(), reference()
    found = simulate(model_of(robot, VISCOUS), target, kp=KP, kd=KD, feedforward="none")
    export_mjcf(robot, tmp_path / "arm.xml", VISCOUS)
    oracle = mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml"))
    oracle.opt.timestep = 0.002
    data = mujoco.MjData(oracle)
    t = target.t
    dq = np.gradient(target.q, t, axis=0, edge_order=2)
    # The same samples as ours: splines give the reference its velocity.
    dq = np.pi * 0.4 * np.cos(np.pi * t[:, None] + np.arange(3))
    data.qpos[:], data.qvel[:] = target.q[0], np.asarray(found.motion.dq)[0]
    path = []
    for k in range(len(t)):
        path.append(data.qpos.copy())
        data.ctrl[:] = KP * (target.q[k] - data.qpos) + KD * (dq[k] - data.qvel)
        mujoco.mj_step(oracle, data)
    np.testing.assert_allclose(np.asarray(found.motion.q), path, atol=2e-4)
    error = np.abs(np.array(path) - target.q).max(axis=0)
    assert error.min() > 0.01  # gravity without feedforward: the reference itself would not pass
    np.testing.assert_allclose(found["tracking_error"]["largest"], error, rtol=0.02)


def test_feedforward_of_the_rigid_body_leaves_what_the_effects_do():
    target = reference()
    bare = simulate(model_of(arm()), target, kp=KP, kd=KD)
    rubbed = simulate(model_of(arm(), VISCOUS), target, kp=KP, kd=KD)
    assert max(bare["tracking_error"]["largest"]) < 1e-4
    assert min(rubbed["tracking_error"]["largest"]) > 1e-3


def test_torques_play_back_to_the_same_motion():
    model, target = model_of(arm(), VISCOUS), reference(751)
    driven = simulate(model, target)
    again = simulate(model, driven.log, playback=True)
    # A zero-order hold was recorded and a first-order one is played back: the difference is of the order dt.
    np.testing.assert_allclose(again.motion.q, driven.motion.q, atol=0.01)
    assert again["gains"] is None


def test_bad_gains_and_torques_that_are_not_there_are_refused():
    model = model_of(arm())
    with pytest.raises(InputError, match="one gain not below zero"):
        simulate(model, reference(101), kp=[1.0, 2.0])
    with pytest.raises(InputError, match="no torque"):
        simulate(model, reference(101), playback=True)
    with pytest.raises(InputError, match="rate"):
        simulate(model, reference(101), rate=-1.0)
    with pytest.raises(InputError, match="diverges"):
        simulate(model, reference(101), kp=1e7, kd=0.0)
