"""Quanta, motion and stuck values, each in a signal made to have a known amount."""

import numpy as np
import pytest

from jaxswarm.logs import quality
from jaxswarm.logs.sampling import sampling

TIME = np.arange(4000) * 0.004
WAVE = np.sin(2 * np.pi * 0.4937 * TIME)


@pytest.mark.parametrize("step", [1e-5, 1e-4, 3.7e-3, 0.05])
@pytest.mark.parametrize("offset", [0.0, 1.234567])
def test_quantum_of_a_rounded_wave(step, offset):
    values = np.round(WAVE / step) * step + offset
    assert quality.quantum(values) == pytest.approx(step, rel=0.02)


def test_quantum_of_single_precision_and_noise_is_none():
    noise = np.random.default_rng(0).normal(size=4000)
    assert quality.quantum(WAVE) == 0.0
    assert quality.quantum(WAVE.astype(np.float32).astype(float)) == 0.0
    assert quality.quantum(noise) == 0.0
    assert quality.quantum(np.full(100, 3.0)) == 0.0


def test_quantum_of_significant_digits_is_that_of_the_usual_values():
    wave = 50.0 * np.sin(2 * np.pi * 0.1 * np.arange(25000) / 5000.0)
    values = np.array([float(f"{x:.4g}") for x in wave]) / 31.0
    # Four digits: steps of 0.01 above 10, of 0.001 above 1.
    assert 0.001 / 31.0 < quality.quantum(values) < 0.0101 / 31.0


def test_velocity_on_irregular_times():
    time = np.sort(np.random.default_rng(1).uniform(0.0, 5.0, 900))
    assert np.allclose(quality.velocity(time, 3.0 * time - 1.0), 3.0)


def test_standstill_is_told_from_motion_through_noise():
    noise = 2e-5 * np.random.default_rng(2).normal(size=len(TIME))
    stop = np.clip(WAVE, -0.5, 0.5) + noise
    speed = np.abs(quality.velocity(TIME, stop))
    threshold = quality.slowest_motion(TIME, stop, speed, 0.0)
    moving = speed > threshold
    # |sin| is below one half for a third of the time.
    assert np.mean(moving) == pytest.approx(1 / 3, abs=0.03)


def test_reversals_ignore_chatter_around_zero():
    chatter = 0.01 * np.sign(np.sin(1e3 * TIME))
    assert quality.reversals(np.cos(2 * np.pi * 0.5 * TIME) + chatter, 0.05) == 16


def test_stuck_needs_motion():
    torque = np.random.default_rng(4).normal(size=4000)
    torque[100:140] = torque[100]
    assert quality.longest_stuck(torque, WAVE, 1e-3) == 40
    assert quality.longest_stuck(torque, np.zeros(4000), 1e-3) == 0


class TestSampling:
    def test_uniform(self):
        clock = sampling(TIME, WAVE[:, None])
        assert clock.rate == pytest.approx(250.0)
        assert clock.jitter < 1e-9 and clock.gaps == ()

    def test_jitter(self):
        periods = np.random.default_rng(5).choice([0.010, 0.012], size=3000)
        time = np.cumsum(periods)
        clock = sampling(time, np.sin(time)[:, None])
        assert clock.rate == pytest.approx(1 / 0.011, rel=0.01)
        assert clock.jitter == pytest.approx(0.001 / 0.011, rel=0.05)
        assert clock.shortest == pytest.approx(0.010) and clock.longest == pytest.approx(0.012)

    def test_missing_samples_are_a_gap(self):
        keep = (np.arange(4000) < 300) | (np.arange(4000) >= 420)
        clock = sampling(TIME[keep], WAVE[keep, None])
        (gap,) = clock.gaps
        assert (gap.sample, gap.clock_jump) == (299, False)
        assert gap.length == pytest.approx(121 * 0.004)
        assert clock.rate == pytest.approx(250.0)

    def test_clock_that_jumps_while_the_motion_goes_on(self):
        time = TIME + 0.48 * (np.arange(4000) >= 300)
        (gap,) = sampling(time, WAVE[:, None]).gaps
        assert (gap.sample, gap.clock_jump) == (299, True)

    def test_a_joint_that_turned_round_in_a_gap_took_its_time(self):
        t = np.delete(np.arange(400) * 0.02, slice(95, 105))
        (gap,) = sampling(t, (t - 2.0)[:, None] ** 2).gaps
        assert not gap.clock_jump

    def test_gap_at_rest_is_no_clock_jump(self):
        time = TIME + 0.48 * (np.arange(4000) >= 300)
        (gap,) = sampling(time, np.ones((4000, 1))).gaps
        assert not gap.clock_jump
