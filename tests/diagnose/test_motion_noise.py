"""The noise of positions is drawn where a log has it: an encoder's steps are none while its joint stands."""

from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.diagnose.folds.motion_noise import noisy
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import rx60

STEP = 2e-5
T = np.arange(0.0, 10.0, 0.004)


def positions():
    """Three seconds of rest, four of motion, three of rest; every joint alike."""
    s = np.clip((T - 3.0) / 4.0, 0.0, 1.0)
    return np.stack([0.3 + c * (10 * s**3 - 15 * s**4 + 6 * s**5) for c in (0.5, 1.0, 0.7)], axis=1)


def prepared(q):
    tau = np.random.default_rng(0).normal(size=q.shape)
    motion = prepare(Log("made", rx60().joints, T, q, tau=tau, channels={}))
    return replace(motion, position_noise=np.full(3, STEP / np.sqrt(12.0)))


def drawn(motion, share=1.0):
    """Accelerations that a draw makes (T, n)."""
    one, none = (noisy(motion, x, np.random.default_rng(1)) for x in (share, 0.0))
    return one.ddq - none.ddq


def rms(x, t, begin, end):
    return np.sqrt((x[(t > begin) & (t < end)] ** 2).mean(axis=0))


def test_an_encoders_steps_are_no_noise_while_its_joint_stands():
    motion = prepared(np.round(positions() / STEP) * STEP)
    more = drawn(motion)
    moving = rms(more, motion.t, 4.0, 6.0)
    assert (moving > 0.0).all()
    assert (rms(more, motion.t, 0.5, 2.5) < 0.01 * moving).all()
    assert (rms(more, motion.t, 7.5, 9.5) < 0.01 * moving).all()


@pytest.mark.parametrize("seed", range(5))
def test_noise_that_is_there_at_rest_is_drawn_there(seed):
    noise = STEP / np.sqrt(12.0) * np.random.default_rng(seed).normal(size=(len(T), 3))
    motion = prepared(positions() + noise)
    more = drawn(motion)
    ratio = rms(more, motion.t, 0.5, 2.5) / rms(more, motion.t, 4.0, 6.0)
    assert (np.abs(np.log(ratio)) < 0.4).all()


def test_twice_the_share_draws_twice_as_much():
    motion = prepared(positions() + 1e-5 * np.random.default_rng(2).normal(size=(len(T), 3)))
    np.testing.assert_allclose(drawn(motion, 2.0), 2.0 * drawn(motion), rtol=1e-6, atol=1e-9)
