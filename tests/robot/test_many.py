"""Robots of many joints run through loops: the numbers stay those of Pinocchio."""

import jax
import jax.numpy as jnp
import numpy as np
import pinocchio as pin
import pytest
from random_robots import random_joints, random_state, to_pinocchio

from jaxswarm.robot import (
    bias_forces,
    build_robot,
    forward_dynamics,
    forward_kinematics,
    gravity_forces,
    in_blocks,
    inverse_dynamics,
    kinetic_energy,
    mass_matrix,
    momentum,
    potential_energy,
    regressor,
)
from jaxswarm.robot.many import MANY


@pytest.fixture(scope="module", params=[("revolute",), ("revolute", "prismatic", "fixed")])
def tree(request):
    """A tree of more joints than are written out, with its Pinocchio model and a state."""
    robot = build_robot("tree", random_joints(3, 40, kinds=request.param))
    assert robot.num_joints > MANY
    model = to_pinocchio(robot)
    return robot, model, model.createData(), *random_state(robot, 4)


def close(a, b, tolerance=1e-10):
    a, b = np.asarray(a), np.asarray(b)
    return a.shape == b.shape and np.abs(a - b).max() <= tolerance * np.abs(b).max()


def test_torques_equal_pinocchio(tree):
    robot, model, data, q, dq, ddq = tree
    assert close(inverse_dynamics(robot, q, dq, ddq), pin.rnea(model, data, q, dq, ddq))
    assert close(gravity_forces(robot, q), pin.computeGeneralizedGravity(model, data, q))
    assert close(bias_forces(robot, q, dq), pin.nonLinearEffects(model, data, q, dq))


def test_regressor_equals_pinocchio(tree):
    robot, model, data, q, dq, ddq = tree
    oracle = pin.computeJointTorqueRegressor(model, data, q, dq, ddq)
    assert close(regressor(robot, q, dq, ddq), oracle)


def test_poses_mass_and_accelerations_equal_pinocchio(tree):
    robot, model, data, q, dq, tau = tree
    pin.forwardKinematics(model, data, q)
    rotation, position = forward_kinematics(robot, q)
    assert close(rotation, np.array([m.rotation for m in data.oMi][1:]))
    assert close(position, np.array([m.translation for m in data.oMi][1:]))
    # Pinocchio's crba wants branches numbered one after the other: its rnea gives the columns.
    still = np.zeros_like(q)
    gravity = pin.rnea(model, data, q, still, still)
    columns = [pin.rnea(model, data, q, still, e) - gravity for e in np.eye(len(q))]
    assert close(mass_matrix(robot, q), np.array(columns).T)
    ddq = forward_dynamics(robot, q, dq, tau)
    assert close(ddq, pin.aba(model, data, q, dq, tau), 1e-8)


def test_energy_and_momentum_equal_pinocchio(tree):
    robot, model, data, q, dq, _ = tree
    assert close(kinetic_energy(robot, q, dq), pin.computeKineticEnergy(model, data, q, dq))
    assert close(potential_energy(robot, q), pin.computePotentialEnergy(model, data, q))
    pin.computeCentroidalMomentum(model, data, q, dq)
    assert close(momentum(robot, q, dq)[:3], data.hg.linear, 1e-9)


def test_lanes_blocks_and_derivatives_follow(tree):
    robot, _, _, q, dq, ddq = tree
    torque = inverse_dynamics(robot, q, dq, ddq)
    lanes = tuple(jnp.stack([x, 0.5 * x, x], axis=1) for x in (q, dq, ddq))
    blocks = jax.jit(lambda s: in_blocks(lambda s: inverse_dynamics(robot, *s), s, size=2))(lanes)
    assert close(blocks[:, 2], torque)
    assert close(forward_dynamics(robot, lanes[0], lanes[1], blocks)[:, 0], ddq, 1e-8)
    matrix = regressor(robot, q, dq, ddq)
    assert close(jnp.einsum("nk,k->n", matrix, robot.parameters.ravel()), torque)
    slope = jax.jit(jax.jacfwd(lambda a: inverse_dynamics(robot, q, dq, a)))(ddq)
    assert close(slope, mass_matrix(robot, q))
    traced = jax.jit(inverse_dynamics)(jax.tree.map(jnp.asarray, robot), q, dq, ddq)
    assert close(traced, torque)
    single = [jnp.asarray(x, jnp.float32) for x in (q, dq, ddq)]
    assert inverse_dynamics(robot, *single).dtype == jnp.float32
