"""Newton-Euler, gravity and the regressor against Pinocchio on random trees."""

import jax
import jax.numpy as jnp
import numpy as np
import pinocchio as pin
import pytest
from random_robots import random_joints, random_state, to_pinocchio

from jaxswarm.robot import (
    BUILTIN_ROBOTS,
    bias_forces,
    build_robot,
    forward_kinematics,
    gravity_forces,
    inverse_dynamics,
    regressor,
    rx60,
    standard_parameter_names,
)
from jaxswarm.robot import spatial as sp

SEEDS = range(4)


def relative(a, b):
    return np.abs(np.asarray(a) - np.asarray(b)).max() / np.abs(np.asarray(b)).max()


def tree(seed):
    return build_robot("tree", random_joints(seed, 7))


@pytest.mark.parametrize("seed", SEEDS)
def test_torques_equal_pinocchio(seed):
    robot = tree(seed)
    model = to_pinocchio(robot)
    data = model.createData()
    q, dq, ddq = random_state(robot, seed)
    assert relative(inverse_dynamics(robot, q, dq, ddq), pin.rnea(model, data, q, dq, ddq)) < 1e-10
    gravity = pin.computeGeneralizedGravity(model, data, q)
    assert relative(gravity_forces(robot, q), gravity) < 1e-10
    assert relative(bias_forces(robot, q, dq), pin.nonLinearEffects(model, data, q, dq)) < 1e-10


@pytest.mark.parametrize("seed", SEEDS)
def test_regressor_equals_pinocchio_and_reproduces_the_torques(seed):
    robot = tree(seed)
    model = to_pinocchio(robot)
    q, dq, ddq = random_state(robot, seed + 10)
    matrix = regressor(robot, q, dq, ddq)
    oracle = pin.computeJointTorqueRegressor(model, model.createData(), q, dq, ddq)
    assert relative(matrix, oracle) < 1e-10
    torque = inverse_dynamics(robot, q, dq, ddq)
    assert relative(matrix @ robot.parameters.ravel(), torque) < 1e-10


@pytest.mark.parametrize("seed", SEEDS)
def test_poses_equal_pinocchio(seed):
    robot = tree(seed)
    model = to_pinocchio(robot)
    data = model.createData()
    q = random_state(robot, seed)[0]
    pin.forwardKinematics(model, data, q)
    rotation, position = forward_kinematics(robot, q)
    for i in range(robot.num_joints):
        np.testing.assert_allclose(rotation[i], data.oMi[i + 1].rotation, atol=1e-12)
        np.testing.assert_allclose(position[i], data.oMi[i + 1].translation, atol=1e-12)


def test_regressor_is_the_jacobian_of_the_torques_in_the_parameters():
    robot = tree(1)
    q, dq, ddq = random_state(robot, 3)

    def torque(parameters):
        return inverse_dynamics(robot.replace(parameters=parameters), q, dq, ddq)

    jacobian = jax.jit(jax.jacfwd(torque))(jnp.asarray(robot.parameters))
    matrix = regressor(robot, q, dq, ddq)
    np.testing.assert_allclose(jacobian.reshape(matrix.shape), matrix, atol=1e-12)


def test_traced_robot_equals_the_robot_known_at_trace_time():
    robot = rx60().replace(parameters=np.random.default_rng(0).normal(size=(3, 10)))
    samples = jnp.asarray(np.random.default_rng(1).normal(size=(3, 5, 3)))
    folded = jax.jit(jax.vmap(lambda *s: regressor(robot, *s)))(*samples)
    traced = jax.jit(jax.vmap(regressor, in_axes=(None, 0, 0, 0)))(robot, *samples)
    np.testing.assert_allclose(folded, traced, atol=1e-12)
    torque = jax.jit(jax.vmap(inverse_dynamics, in_axes=(None, 0, 0, 0)))(robot, *samples)
    np.testing.assert_allclose(folded @ robot.parameters.ravel(), torque, atol=1e-11)


def test_lanes_equal_samples():
    robot = tree(2)
    n = robot.num_joints
    samples = jnp.asarray(np.random.default_rng(1).normal(size=(3, n, 4)))
    parameters = jnp.asarray(np.random.default_rng(2).normal(size=(n, 10, 4)))
    lanes = inverse_dynamics(robot.replace(parameters=parameters), *samples)
    for k in range(4):
        one = robot.replace(parameters=parameters[..., k])
        np.testing.assert_allclose(lanes[:, k], inverse_dynamics(one, *samples[..., k]), rtol=1e-10)


def test_torques_are_differentiable_in_state_and_placement():
    robot = rx60().replace(parameters=np.random.default_rng(0).normal(size=(3, 10)))
    q, dq, ddq = random_state(robot, 5)

    @jax.jit
    def torque(q, translation):
        return inverse_dynamics(robot.replace(translation=translation), q, dq, ddq)[1]

    slope_q, slope_place = jax.grad(torque, argnums=(0, 1))(q, jnp.asarray(robot.translation))
    step = 1e-6
    for j in range(3):
        e = step * np.eye(3)[j]
        numeric = (torque(q + e, robot.translation) - torque(q - e, robot.translation)) / (2 * step)
        assert abs(slope_q[j] - numeric) < 1e-7
    e = np.zeros((3, 3))
    e[2, 0] = step
    numeric = torque(q, robot.translation + e) - torque(q, robot.translation - e)
    assert abs(slope_place[2, 0] - numeric / (2 * step)) < 1e-7


def test_torques_follow_the_dtype_of_the_motion():
    q = jnp.zeros(3, jnp.float32)
    assert inverse_dynamics(rx60(), q, q, q).dtype == jnp.float32
    assert regressor(rx60(), q, q, q).dtype == jnp.float32


def test_rx60_in_the_thirteen_parameters_of_its_paper():
    """The base combinations of papers.md: joint 1 alone sees Czz1 + Byy2 + Byy3 at q = 0."""
    robot = rx60()
    q, zero = jnp.zeros(3), jnp.zeros(3)
    tau = inverse_dynamics(robot, q, zero, jnp.array([1.0, 0.0, 0.0]))
    assert abs(tau[0] - (5.0091 + 2.4129 + 1.3125)) < 1e-12
    np.testing.assert_allclose(gravity_forces(robot, q), 0.0, atol=1e-12)
    model = to_pinocchio(robot)
    q, dq, ddq = random_state(robot, 7)
    oracle = pin.computeJointTorqueRegressor(model, model.createData(), q, dq, ddq)
    assert relative(inverse_dynamics(robot, q, dq, ddq), oracle @ robot.parameters.ravel()) < 1e-10


def test_emps_feels_no_gravity_and_weighs_its_mass():
    robot = BUILTIN_ROBOTS["emps"]()
    robot = robot.replace(parameters=robot.parameters + np.array([95.0] + [0.0] * 9))
    one = jnp.ones(1)
    assert gravity_forces(robot, one)[0] == 0.0
    assert inverse_dynamics(robot, one, one, 2.0 * one)[0] == 190.0


def test_parameter_names_count_links_from_one():
    names = standard_parameter_names(rx60())
    assert len(names) == 30
    assert names[0] == "m1" and names[13] == "mz2" and names[29] == "Izz3"


def test_settled_entries_keep_their_values_and_derivatives():
    """A long arm stores what it hands on: the numbers are the same, known ones stay known."""
    x = jnp.array([0.3, -0.7, 1e-300])
    kept, (known, last) = sp.settle((x, (0.0, x * x)))
    assert known == 0.0 and isinstance(known, float)
    np.testing.assert_array_equal(kept, x)
    np.testing.assert_array_equal(last, x * x)
    slope = jax.grad(lambda x: sum(sp.settle((x[0] * x[1], x[1] ** 2))))(x)
    np.testing.assert_allclose(slope, [x[1], x[0] + 2 * x[1], 0.0])
