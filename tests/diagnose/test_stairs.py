"""Weight that comes in steps makes other joints answer, by as much as their inertia is larger."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, log_with, small_arm

from jaxswarm.diagnose.folds.noise import noise_of, with_motion_noise
from jaxswarm.diagnose.folds.stairs import stair_noise
from jaxswarm.identify import estimate
from jaxswarm.identify.forward.columns import torque_of
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs.motion import Filtering, prepare

_EARLY = -0.003


@pytest.fixture(scope="module")
def told():
    return prepare(log_with(), BAND), Model(small_arm(), (), (1.0, 1.0), Filtering(), (1.0, 1.0))


def test_weight_that_is_told_with_all_torque_shakes_nothing(told):
    motion, model = told
    assert not stair_noise(model, motion).any()


def test_a_joint_answers_to_the_weight_of_the_others_by_the_root_of_their_inertias(told):
    motion, model = told
    robot, n = model.robot, motion.q.shape[1]
    made = stair_noise(model, replace(motion, weight_skew=_EARLY))
    rest, pi = np.zeros_like(motion.q), np.asarray(robot.parameters).ravel()
    weight = torque_of(robot, motion.q, rest, rest, pi)
    change = motion.decimator.apply(np.gradient(weight, motion.t, axis=0))
    inertia = np.array(
        [
            (torque_of(robot, motion.q, rest, rest + one, pi) - weight)[:, j].mean()
            for j, one in enumerate(np.eye(n))
        ]
    )
    for j in range(n):
        others = [k for k in range(n) if k != j]
        power = (inertia[j] / inertia[others] * change[:, others] ** 2).sum(axis=1)
        expected = motion.interval / 12.0 * np.sqrt(power.mean())
        assert np.sqrt((made[:, j] ** 2).mean()) == pytest.approx(expected, rel=0.05)


def test_it_is_noise_that_no_model_goes_below(told):
    motion, model = told
    found = estimate(model.robot, (), [motion], bounded=False)
    moved = replace(motion, weight_skew=_EARLY)
    plain, shaken = (
        noise_of(with_motion_noise(replace(found, motions=(one,)))) for one in (motion, moved)
    )
    assert (shaken > plain).all()
