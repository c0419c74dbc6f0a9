"""What a log hardly tells is held by torques that other motion would not ask for; what it tells stays."""

import importlib
from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.identify import estimate, model_torque
from jaxswarm.identify.forward.torque_prior import torque_prior
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import emps, rx60
from jaxswarm.robot.logged import rigid_torque

problem = importlib.import_module("jaxswarm.identify.estimation.problem")
T = np.arange(0.0, 12.0, 0.005)


def logged(q, noise, seed=0):
    """A log of the arm without friction along positions (T, 3)."""
    rng = np.random.default_rng(seed)
    dq = np.gradient(q, T, axis=0)
    tau = rigid_torque(rx60(), q, dq, np.gradient(dq, T, axis=0))
    tau = tau + noise * rng.normal(size=q.shape)
    return prepare(
        Log("made", rx60().joints, T, q + 1e-5 * rng.normal(size=q.shape), tau=tau, channels={})
    )


def one_by_one():
    """Joints that move one by one, a little, and never back."""
    q = np.zeros((len(T), 3))
    for j in range(3):
        for begin, far in ((3 * j + 0.5, 0.15), (3 * j + 1.5, 0.1)):
            s = np.clip(T - begin, 0.0, 1.0)
            q[:, j] += far * (10 * s**3 - 15 * s**4 + 6 * s**5)
    return q


def together():
    """All joints at once, to and fro."""
    phase = np.random.default_rng(1).uniform(0.0, 6.0, (3, 4))
    angle = 2 * np.pi * 0.17 * np.arange(1, 5)[:, None] * T
    return 0.3 * np.sin(angle[None] + phase[:, :, None]).sum(axis=1).T


def left(found, motion):
    """RMS of what a model leaves (n,)."""
    error = motion.decimator.apply(motion.tau - model_torque(found.model, motion))
    return np.sqrt((error**2).mean(axis=0))


@pytest.fixture
def without_prior(monkeypatch):
    def fitted(motion):
        monkeypatch.setattr(problem, "torque_prior", lambda robot, motions: np.zeros((0, 30)))
        return estimate(rx60(), (), [motion])

    return fitted


def test_on_other_motion_a_model_is_off_by_less_where_joints_move_one_by_one(without_prior):
    motion, other = logged(one_by_one(), 0.3), logged(together(), 0.05, seed=2)
    held = estimate(rx60(), (), [motion])
    free = without_prior(motion)
    assert (left(held, other) < 0.5 * left(free, other)).all()
    np.testing.assert_allclose(left(held, motion), left(free, motion), rtol=0.01)
    # And it knows that it does not know: what is held has the doubt of what holds it.
    assert held.fit.std_error.max() < 0.2 * free.fit.std_error.max()
    assert held.fit.std_error.max() > 10.0


def test_what_a_log_tells_stays(without_prior):
    motion = logged(together(), 0.05)
    held = estimate(rx60(), (), [motion]).fit
    free = without_prior(motion).fit
    assert (np.abs(held.values - free.values) < 0.01 * free.std_error).all()
    np.testing.assert_allclose(held.std_error, free.std_error, rtol=1e-3)


def test_torques_of_other_motion_are_within_the_largest_seen():
    """By the true arm, whose log asks for what its other motion does, the rows are well below one each."""
    rows = torque_prior(rx60(), [logged(together(), 0.0)])
    size = np.linalg.norm(rows @ np.asarray(rx60().parameters).ravel())
    assert 0.1 < size / np.sqrt(3.0) < 1.0


def test_what_only_a_base_feels_is_held_more_loosely():
    """The height of the first link's mass: no joint of a level arm feels it, a base that gives way does."""
    motion = logged(together(), 0.0)
    rows = torque_prior(rx60(), [motion])
    height, beside = (np.linalg.norm(rows[:, column]) for column in (3, 11))
    largest = np.abs(motion.low_torque).max()
    # Ten times the largest torque holds 1 kg m on a base that is turned any way, of which two axes are asked.
    assert height == pytest.approx(9.81 / (10.0 * largest), rel=0.3)
    assert beside > 5.0 * height


def test_a_joint_without_torque_holds_nothing():
    motion = logged(together(), 0.0)
    motion = replace(motion, tau=motion.tau * np.array([0.0, 1.0, 1.0]))
    assert np.isfinite(torque_prior(rx60(), [motion])).all()
    assert len(torque_prior(rx60(), [replace(motion, tau=0.0 * motion.tau)])) == 0


def test_a_slide_alone_is_held_by_forces_of_its_size():
    arm = emps()
    q = 0.1 * np.sin(2.0 * T)[:, None]
    motion = prepare(Log("made", arm.joints, T, q, tau=-40.0 * q, channels={}))
    rows = torque_prior(arm, [motion])
    assert rows.shape == (10, 10) and 1e-6 < np.abs(rows).max() < 1e3
