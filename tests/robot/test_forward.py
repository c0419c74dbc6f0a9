"""Mass matrix, forward dynamics, energy and momentum against Pinocchio and each other."""

import jax
import jax.numpy as jnp
import numpy as np
import pinocchio as pin
import pytest
from random_robots import random_joints, random_state, to_pinocchio

from jaxswarm.errors import InputError
from jaxswarm.robot import (
    bias_forces,
    build_robot,
    check_mass_matrix,
    forward_dynamics,
    gravity_forces,
    inverse_dynamics,
    kinetic_energy,
    mass_matrix,
    momentum,
    potential_energy,
    ur10e,
)


@pytest.fixture(scope="module", params=range(3))
def tree(request):
    robot = build_robot("tree", random_joints(request.param, 7))
    q, dq, tau = random_state(robot, request.param)
    return robot, q, dq, tau


def close(a, b, tolerance=1e-9):
    return np.abs(np.asarray(a) - np.asarray(b)).max() <= tolerance * np.abs(np.asarray(b)).max()


def test_mass_matrix_equals_pinocchio(tree):
    robot, q, _, _ = tree
    model = to_pinocchio(robot)
    oracle = pin.crba(model, model.createData(), q)
    oracle = np.triu(oracle) + np.triu(oracle, 1).T
    assert close(mass_matrix(robot, q), oracle)


def test_accelerations_equal_pinocchio_and_close_the_circle(tree):
    robot, q, dq, tau = tree
    model = to_pinocchio(robot)
    ddq = forward_dynamics(robot, q, dq, tau)
    assert close(ddq, pin.aba(model, model.createData(), q, dq, tau))
    assert close(inverse_dynamics(robot, q, dq, ddq), tau)
    assert close(mass_matrix(robot, q) @ ddq + bias_forces(robot, q, dq), tau)


def test_energies_and_momentum_equal_pinocchio(tree):
    robot, q, dq, _ = tree
    model = to_pinocchio(robot)
    data = model.createData()
    assert close(kinetic_energy(robot, q, dq), pin.computeKineticEnergy(model, data, q, dq))
    assert close(potential_energy(robot, q), pin.computePotentialEnergy(model, data, q))
    slope = jax.grad(lambda q: potential_energy(robot, q))(jnp.asarray(q))
    np.testing.assert_allclose(slope, gravity_forces(robot, q), atol=1e-9)
    pin.forwardKinematics(model, data, q, dq)
    oracle = np.zeros(6)
    for i in range(1, model.njoints):
        oracle += data.oMi[i].act(model.inertias[i] * data.v[i]).vector
    assert close(momentum(robot, q, dq), oracle)


def test_accelerations_are_differentiable():
    robot = build_robot("tree", random_joints(1, 4))
    q, dq, tau = random_state(robot, 1)

    @jax.jit
    def acceleration(parameters):
        return forward_dynamics(robot.replace(parameters=parameters), q, dq, tau)[0]

    parameters = jnp.asarray(robot.parameters)
    slope = jax.jit(jax.grad(acceleration))(parameters)
    for index in [(0, 9), (1, 2), (1, 6)]:
        step = jnp.zeros_like(parameters).at[index].set(1e-5)
        numeric = (acceleration(parameters + step) - acceleration(parameters - step)) / 2e-5
        assert abs(slope[index] - numeric) < 1e-6 * max(1.0, abs(numeric))


def test_robot_without_inertia_is_refused_and_gives_nan():
    robot = ur10e()
    with pytest.raises(InputError, match="singular or negative"):
        check_mass_matrix(robot, np.zeros(6))
    zero = jnp.zeros(6)
    assert np.isnan(forward_dynamics(robot, zero, zero, zero)).all()
