"""What sampling leaves unknown of torques that jump, against torques that jump at times drawn at random."""

import numpy as np
import pytest

from jaxswarm.logs.filtering import design_decimator
from jaxswarm.logs.resampling import thin
from jaxswarm.logs.steps import step_noise

_SIZE, _SECONDS, _FINE = 30.0, 4.0, 64


@pytest.mark.parametrize(("rate", "stride"), [(200.0, 1), (1000.0, 4)])
def test_the_doubt_is_the_spread_over_the_times_of_the_jump(rate, stride):
    rng = np.random.default_rng(0)
    low = design_decimator(rate / stride, 8.0)
    t = np.arange(0.0, _SECONDS, 1.0 / (rate * _FINE))

    def in_the_band(jump):
        means = np.where(t < jump, 0.0, _SIZE).reshape(-1, _FINE).mean(axis=1)
        return low.apply(thin(means[:, None], rate, stride))[:, 0]

    # All of them are logged alike: the jump is between the same two samples.
    when = 0.5 * _SECONDS + rng.uniform(0.0, 1.0, 300) / rate
    spread = np.std([in_the_band(jump) for jump in when], axis=0)
    clock = np.arange(0.0, _SECONDS, 1.0 / rate)
    logged = np.where(clock < when[0], 0.0, _SIZE)[:, None]
    doubt = step_noise(thin(logged, rate, stride), 1.0 / stride, low, 0)[:, 0]
    assert doubt.max() == pytest.approx(spread.max(), rel=0.15 if stride == 1 else 0.5)
    assert abs(int(doubt.argmax()) - int(spread.argmax())) <= 1


def test_noise_and_what_changes_steadily_are_no_jumps():
    rng = np.random.default_rng(1)
    t = np.arange(0.0, 20.0, 0.002)[:, None]
    torque = np.hstack([20.0 * np.sin(2 * np.pi * t), 0.3 * rng.normal(size=t.shape)])
    doubt = step_noise(torque, 1.0, design_decimator(500.0, 10.0), 0)
    assert doubt[:, 1].max() == 0.0
    # A sine's change between samples is beyond that of its neighbors by its curvature only.
    assert doubt[:, 0].max() < 1e-3 * 20.0


def test_what_lasts_after_a_jump_is_no_doubt_and_what_smoothing_leaves_of_one_is():
    low, t = design_decimator(200.0, 10.0), np.arange(0.0, 4.0, 0.005)
    push = 6.0 * ((t > 2.0) & (t < 2.5))
    step = np.where(t < 2.0, 0.0, 30.0)
    smoothed = 30.0 / (1.0 + np.exp(-np.clip((t - 2.0) / 0.008, -50, 50)))
    doubt = step_noise(np.column_stack([push, step - smoothed]), 1.0, low, 20)
    assert doubt[:, 0].max() < 0.02 * 6.0 / 30.0 < 0.2 < doubt[:, 1].max()
