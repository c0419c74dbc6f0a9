"""Torques by where a joint sits, against those of an arm whose joint does sit there."""

import numpy as np
import pytest
from random_robots import random_joints, random_state

from jaxswarm.robot import build_robot
from jaxswarm.robot.displaced import displacement_slopes
from jaxswarm.robot.logged import BLOCK, rigid_torque
from jaxswarm.robot.placements import rotation_rpy

_STEP = 1e-4


def displaced(robot, joint, shift, turn):
    """The robot whose joint's frame is shifted and turned in its parent's."""
    translation, rotation = np.array(robot.translation), np.array(robot.rotation)
    translation[joint] += shift
    # Small turns about the three axes follow each other in any order.
    rotation[joint] = rotation_rpy(turn) @ rotation[joint]
    return robot.replace(translation=translation, rotation=rotation)


@pytest.mark.parametrize("seed", range(4))
def test_slopes_are_those_of_the_displaced_arm(seed):
    robot = build_robot("tree", random_joints(seed, 9))
    states = [random_state(robot, k) for k in range(4)]
    log = tuple(np.stack(x) for x in zip(*states, strict=True))
    for joint in range(robot.num_joints):
        moves = np.eye(6).reshape(6, 2, 3)
        found = displacement_slopes(robot, *log, joint, moves)
        for k, (shift, turn) in enumerate(_STEP * moves):
            ends = [
                rigid_torque(displaced(robot, joint, s * shift, s * turn), *log) for s in (1, -1)
            ]
            wanted = (ends[0] - ends[1]) / (2 * _STEP)
            np.testing.assert_allclose(
                found[:, :, k], wanted, atol=1e-6 * max(1.0, np.abs(wanted).max())
            )


def test_a_long_log_goes_through_in_parts():
    robot = build_robot("tree", random_joints(0, 5))
    log = np.random.default_rng(0).normal(size=(3, BLOCK + 7, robot.num_joints))
    moves = np.ones((1, 2, 3))
    found = displacement_slopes(robot, *log, 1, moves)
    ends = displacement_slopes(robot, *log[:, -20:], 1, moves)
    np.testing.assert_allclose(found[-20:], ends, rtol=1e-10, atol=1e-10)
