"""Torques at a limit: what is cut off counts, what turns around within a step of the channel does not."""

import numpy as np
import pytest

from jaxswarm.logs import Log
from jaxswarm.logs.clipping import clipped
from jaxswarm.logs.frozen import without_saturated

TIME = np.arange(4000) * 0.004
WAVE = np.sin(2 * np.pi * 0.4937 * TIME)
EVERYWHERE = np.full(len(TIME), True)


@pytest.mark.parametrize("limit", [0.5, 0.8, 0.95])
@pytest.mark.parametrize("step", [0.0, 0.01])
def test_the_clipped_samples_are_found(limit, step):
    wave = WAVE if step == 0.0 else np.round(WAVE / step) * step
    cut = np.clip(wave, -limit, 10.0)
    assert (clipped(cut, EVERYWHERE) == (wave <= -limit)).all()
    assert not clipped(wave, EVERYWHERE).any()
    assert not clipped(cut, ~EVERYWHERE).any()  # no noise: it may rest there


def test_noise_and_constants_are_at_no_limit():
    noise = np.random.default_rng(3).normal(size=4000)
    assert not clipped(noise, EVERYWHERE).any()
    assert not clipped(np.ones(4000), EVERYWHERE).any()


@pytest.mark.parametrize("seed", range(20))
def test_a_crest_that_a_coarse_channel_rounds_is_no_limit(seed):
    """One highest crest among many, a step of the channel wide, with a tenth of a step of noise."""
    rng = np.random.default_rng(seed)
    t = np.arange(800) * 0.02
    torque = sum(np.sin(k * 0.4 * t + rng.uniform(0.0, 7.0)) / k for k in range(1, 5))
    step = rng.choice([0.003, 0.01, 0.03])
    coarse = np.round((torque + 0.1 * step * rng.normal(size=len(t))) / step) * step
    assert not clipped(coarse, np.full(len(t), True)).any()


def test_a_crest_as_it_was_logged_is_no_limit():
    """Ten equal samples at the top of a torque in steps, between slopes that end there."""
    crest = [
        249,
        251,
        253,
        255,
        256,
        258,
        259,
        260,
        261,
        263,
        264,
        265,
        267,
        268,
        269,
        271,
        271,
        272,
        272,
    ]
    crest += [272] * 8 + [270, 269, 270, 267, 267, 266, 266, 265, 262, 263]
    far = np.round(130.0 * np.sin(np.linspace(0.0, 40.0, 700)))
    torque = np.concatenate([far, crest, far[::-1]])
    assert not clipped(torque, np.full(len(torque), True)).any()


def test_a_joint_at_rest_may_need_one_torque():
    """A crest, a rest at the largest torque, and motion again: the rest is no limit."""
    torque = np.concatenate([WAVE[:1000], np.full(500, 1.5), WAVE[1000:]])
    moving = np.concatenate([EVERYWHERE[:1000], np.full(500, False), EVERYWHERE[1000:]])
    assert not clipped(torque, moving).any()


@pytest.mark.parametrize("step", [0.0, 0.015])
def test_a_noisy_torque_that_stands_at_its_top_is_cut_at_rest_too(step):
    """Weight at the limit while the joint rests: in noise no torque is one number for long."""
    weight = np.concatenate([WAVE[:1000], np.full(500, 1.5), WAVE[1000:]])
    rng = np.random.default_rng(0)
    torque = weight + 0.01 * rng.normal(size=len(weight))
    torque = torque if step == 0.0 else np.round(torque / step) * step
    moving = np.concatenate([EVERYWHERE[:1000], np.full(500, False), EVERYWHERE[1000:]])
    for limit, least in ((1.3, 500), (1.485, 350)):
        assert clipped(np.minimum(torque, limit), moving).sum() >= least
    assert not clipped(torque, moving).any()


def log_with(tau: np.ndarray) -> Log:
    return Log("demo", ("joint1",), TIME, np.cos(3.0 * TIME)[:, None], tau=tau[:, None])


def test_a_few_samples_at_a_limit_are_left_out_and_told():
    peaks = WAVE + 0.5 * np.exp(-(((TIME - 8.6) / 0.2) ** 2))
    cut = np.minimum(peaks, 1.2)
    log, (found,) = without_saturated(log_with(cut))
    assert not found.refused and "left out" in found.remedy and found.check == "saturation"
    lost = np.setdiff1d(TIME, log.t)
    assert (cut[np.isin(TIME, lost)] == 1.2).all() and len(lost) == (peaks >= 1.2).sum() > 20
    assert np.interp(log.t, TIME, peaks) == pytest.approx(log.tau[:, 0])


def test_a_log_that_is_often_at_its_limit_is_refused():
    log, (found,) = without_saturated(log_with(np.minimum(WAVE, 0.7)))
    assert found.refused and len(log.t) == len(TIME) and "larger range" in found.remedy
