"""Torques and columns along a log against Pinocchio, sample by sample."""

import numpy as np
import pinocchio as pin
import pytest
from random_robots import random_joints, random_state, to_pinocchio

from jaxswarm.robot import build_robot, rx60
from jaxswarm.robot.logged import rigid_columns, rigid_torque, rigid_torques


def log_of(robot, size):
    """Random states of a robot, q, dq, ddq, each (size, n)."""
    states = [random_state(robot, seed) for seed in range(size)]
    return tuple(np.stack(x) for x in zip(*states, strict=True))


@pytest.mark.parametrize("seed", range(4))
def test_every_sample_equals_pinocchio(seed):
    # Fixed joints are lumped: 20 joints of a random tree leave chains, forks and slides.
    robot = build_robot("tree", random_joints(seed, 20))
    model = to_pinocchio(robot)
    data = model.createData()
    log = log_of(robot, 5)
    torque, columns = rigid_torque(robot, *log), rigid_columns(robot, *log)
    for k, state in enumerate(zip(*log, strict=True)):
        wanted = pin.rnea(model, data, *state)
        np.testing.assert_allclose(torque[k], wanted, atol=1e-10 * np.abs(wanted).max())
        wanted = pin.computeJointTorqueRegressor(model, data, *state)
        np.testing.assert_allclose(columns[k], wanted, atol=1e-10 * np.abs(wanted).max())


def test_links_that_are_left_out_change_nothing_of_the_others():
    robot = rx60()
    log = log_of(robot, 7)
    whole = rigid_columns(robot, *log)
    np.testing.assert_array_equal(rigid_columns(robot, *log, first=1), whole[:, :, 10:])


def test_parameters_of_every_sample_are_those_of_its_robot():
    robot = rx60()
    # More samples than pass at a time, so that the blocks meet.
    q, dq, ddq = np.random.default_rng(0).normal(size=(3, 5000, 3))
    share = np.linspace(0.5, 2.0, 5000)
    light = robot.replace(parameters=np.asarray(robot.parameters)[:, :, None] * share)
    torque = rigid_torque(light, q, dq, ddq)
    np.testing.assert_allclose(torque, rigid_torque(robot, q, dq, ddq) * share[:, None], rtol=1e-10)


@pytest.mark.parametrize("still", ["nothing", "velocity", "a joint", "everything"])
def test_many_sets_of_parameters_give_what_the_columns_say(still):
    """What stays the same in all samples is a known number there, and changes nothing."""
    robot = build_robot("tree", random_joints(1, 20))
    log = np.stack(log_of(robot, 9))
    log[{"nothing": [], "velocity": 1, "a joint": np.s_[:, :, 0]}.get(still, ...)] = 0.0
    parameters = np.random.default_rng(2).normal(size=(10 * robot.num_joints - 10, 3))
    torques = rigid_torques(robot, *log, parameters, first=1)
    columns = rigid_columns(robot, *log, first=1)
    wanted = np.moveaxis(columns @ parameters, 0, -1)
    np.testing.assert_allclose(torques, wanted, atol=1e-12 * np.abs(wanted).max())


def test_a_joint_that_does_the_same_in_all_samples_moves_as_in_each():
    robot = build_robot("tree", random_joints(2, 20))
    q, dq, ddq = log_of(robot, 6)
    dq[:, :2], ddq[:, 1] = 0.7, 0.0
    torque, columns = rigid_torque(robot, q, dq, ddq), rigid_columns(robot, q, dq, ddq)
    for k in range(6):
        one = (x[k : k + 1] for x in (q, dq, ddq))
        np.testing.assert_allclose(columns[k], rigid_columns(robot, *one)[0], atol=1e-12)
        wanted = columns[k] @ np.asarray(robot.parameters).ravel()
        np.testing.assert_allclose(torque[k], wanted, atol=1e-10 * np.abs(wanted).max())
