"""Responses, derivatives and the decimator, against formulas and SciPy's Butterworth."""

import subprocess
import sys

import numpy as np
import pytest
from scipy import signal

from jaxswarm.logs.cutoffs import find_cutoffs
from jaxswarm.logs.filtering import (
    Decimator,
    acceleration_valley,
    derivatives,
    design_decimator,
    noise_floor,
    power_density,
)
from jaxswarm.logs.smoothing import smooth

RATE = 200.0
INSIDE = slice(400, -400)


def wave(frequency, length=2000, rate=RATE, phase=0.3):
    return np.cos(2 * np.pi * frequency * np.arange(length) / rate + phase)


@pytest.mark.parametrize("frequency", [0.0, 1.0, 4.0, 6.0, 10.0, 15.0, 30.0])
def test_smooth_has_the_promised_response_and_no_phase(frequency):
    cutoff, x = 6.0, wave(frequency)
    # In discrete time w stands for 2 sin(w/2), as the fourth difference has it.
    ratio = np.sin(np.pi * frequency / RATE) / np.sin(np.pi * cutoff / RATE)
    gain = 1.0 / (1.0 + ratio**8)
    np.testing.assert_allclose(smooth(x, RATE, cutoff)[INSIDE], gain * x[INSIDE], atol=1e-9)
    assert gain == pytest.approx(1.0 / (1.0 + (frequency / cutoff) ** 8), abs=0.01)


def test_smooth_is_a_butterworth_run_both_ways():
    x = np.cumsum(np.random.default_rng(0).normal(size=4000)) * 0.1
    sections = signal.butter(4, 5.0, fs=RATE, output="sos")
    expected = signal.sosfiltfilt(sections, x)
    np.testing.assert_allclose(
        smooth(x, RATE, 5.0)[INSIDE], expected[INSIDE], atol=2e-3 * np.ptp(x)
    )


def test_smooth_keeps_cubics_up_to_the_ends():
    t = np.linspace(-1.0, 1.0, 300)
    x = np.stack([np.ones_like(t), t, t**2, t**3], axis=1)
    np.testing.assert_allclose(smooth(x, RATE, 3.0), x, atol=1e-6)


def test_smooth_is_linear_and_reverses():
    a, b = np.random.default_rng(1).normal(size=(2, 200, 3))
    both = smooth(2.0 * a - b, RATE, 10.0)
    np.testing.assert_allclose(
        both, 2.0 * smooth(a, RATE, 10.0) - smooth(b, RATE, 10.0), atol=1e-10
    )
    np.testing.assert_allclose(smooth(a[::-1], RATE, 10.0), smooth(a, RATE, 10.0)[::-1], atol=1e-10)


@pytest.mark.parametrize(("length", "cutoff"), [(200, 95.0), (200, 400.0), (8, 5.0), (1, 5.0)])
def test_smooth_returns_what_it_cannot_filter(length, cutoff):
    x = np.random.default_rng(2).normal(size=length)
    found = smooth(x, RATE, cutoff)
    np.testing.assert_array_equal(found, x)
    found[0] = 7.0
    assert x[0] != 7.0


def test_derivatives_of_sines_and_polynomials():
    t = np.arange(600) / RATE
    x = np.stack([np.sin(5.0 * t), np.cos(9.0 * t)], axis=1)
    first, second = derivatives(x, RATE, 2)
    np.testing.assert_allclose(
        first, np.stack([5 * np.cos(5 * t), -9 * np.sin(9 * t)], 1), atol=1e-6
    )
    exact = np.stack([-25 * np.sin(5 * t), -81 * np.cos(9 * t)], axis=1)
    np.testing.assert_allclose(second[5:-5], exact[5:-5], atol=1e-5)
    np.testing.assert_allclose(second, exact, atol=2e-2)
    quintic = derivatives(t**5, RATE, 3)
    for found, expected in zip(quintic, (5 * t**4, 20 * t**3, 60 * t**2), strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-4)


def test_noise_floor_finds_a_white_noise_density():
    noise = np.random.default_rng(3).normal(0.0, 0.02, 40000)
    _, density, floor = noise_floor(noise + wave(2.0, 40000), RATE)
    # One-sided density of white noise: variance over half the rate.
    assert floor[0] == pytest.approx(0.02**2 / (RATE / 2), rel=0.05)
    assert density.shape[1] == 1


@pytest.mark.parametrize("sigma", [1e-5, 1e-3])
def test_valley_lies_between_motion_and_noise(sigma):
    rng = np.random.default_rng(4)
    motion = sum(wave(f, 8000) / f**2 for f in (0.3, 0.8, 1.5, 2.4))
    valley = acceleration_valley(motion + rng.normal(0.0, sigma, 8000), RATE)[0]
    assert 2.4 < valley < 60.0


def test_more_noise_lowers_the_valley():
    sections = signal.butter(4, 3.0, fs=RATE, output="sos")
    motion = signal.sosfilt(sections, np.random.default_rng(5).normal(size=16000))
    noise = np.random.default_rng(6).normal(size=16000)
    low, high = (acceleration_valley(motion + s * noise, RATE)[0] for s in (1e-3, 1e-7))
    assert 3.0 < low < high


def test_valley_of_a_joint_at_rest_is_the_whole_band():
    np.testing.assert_allclose(acceleration_valley(np.zeros((1000, 2)), RATE), 0.475 * RATE)


@pytest.fixture(scope="module")
def decimator() -> Decimator:
    return design_decimator(RATE, 10.0)


def test_decimator_keeps_constants_and_slow_sines(decimator):
    assert decimator.factor == 8
    kept = decimator.kept(2000)
    np.testing.assert_allclose(decimator.apply(np.ones(2000)), 1.0, atol=1e-12)
    for frequency in (0.2, 2.0, 5.0):
        x = wave(frequency)
        np.testing.assert_allclose(decimator.apply(x), x[kept], atol=1e-3)


def test_decimator_halves_at_the_cutoff_and_stops_what_would_fold(decimator):
    x = wave(10.0)
    np.testing.assert_allclose(decimator.apply(x), 0.5 * x[decimator.kept(2000)], atol=1e-3)
    for frequency in (15.0, 25.0, 60.0, 99.0):
        assert np.abs(decimator.apply(wave(frequency))).max() < 1e-3


def test_decimator_is_linear_and_the_same_on_torque_and_columns(decimator):
    rng = np.random.default_rng(7)
    columns, theta = rng.normal(size=(700, 3, 5)), rng.normal(size=5)
    low = decimator.apply(columns)
    assert low.shape == (len(decimator.kept(700)), 3, 5)
    np.testing.assert_allclose(low @ theta, decimator.apply(columns @ theta), atol=1e-12)


@pytest.mark.parametrize("length", [201, 400, 1999, 2000, 2001])
def test_decimator_length_is_that_of_its_clock(decimator, length):
    x = np.arange(float(length))
    found = decimator.apply(x)
    # A symmetric filter that sums to one returns a straight line as it is.
    np.testing.assert_allclose(found, x[decimator.kept(length)], atol=1e-8)


@pytest.mark.parametrize("cutoff", [80.0, 100.0])
def test_decimator_near_nyquist_is_the_identity(cutoff):
    low = design_decimator(RATE, cutoff)
    x = np.random.default_rng(8).normal(size=(50, 2))
    np.testing.assert_array_equal(low.apply(x), x)
    np.testing.assert_array_equal(low.kept(50), np.arange(50))


def test_smooth_is_the_dense_solution_with_and_without_a_velocity():
    rng = np.random.default_rng(3)
    length, rate, cutoff, rho = 60, 50.0, 5.0, 0.004
    x, v = rng.normal(size=(2, length, 1))
    penalty = np.diff(np.eye(length), 4, axis=0)
    weight = (2 * np.sin(np.pi * cutoff / rate)) ** -8
    stencil = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60 * rate
    slope = np.zeros((length, length))
    for k in range(length - 6):
        slope[k + 3, k : k + 7] = stencil
    clock = np.arange(length) / rate
    for k in (
        0,
        1,
        2,
        -3,
        -2,
        -1,
    ):  # at the ends, the derivative of the polynomial through seven samples
        near = slice(0, 7) if k >= 0 else slice(-7, None)
        powers = np.vander(clock[near] - clock[k], increasing=True)
        slope[k, near] = np.linalg.inv(powers)[1]
    system = np.eye(length) + weight * penalty.T @ penalty
    np.testing.assert_allclose(smooth(x, rate, cutoff), np.linalg.solve(system, x), atol=1e-9)
    system += rho * slope.T @ slope
    right = x + rho * slope.T @ v
    fused = smooth(x, rate, cutoff, v, np.array([rho]))
    np.testing.assert_allclose(fused, np.linalg.solve(system, right), atol=1e-9)


def test_cutoffs_of_joints_together_are_those_of_each_alone():
    rng = np.random.default_rng(4)
    q = 1e-5 * rng.normal(size=(3000, 3)).cumsum(0).cumsum(0) + 1e-3 * rng.normal(size=(3000, 3))
    q[:, 1] = 0.7  # at rest
    v, ratio = np.gradient(q, 1 / RATE, axis=0), np.array([0.0, 0.0, 1e-4])
    together = find_cutoffs(q, RATE, v, ratio)
    for j in range(3):
        alone = find_cutoffs(q[:, [j]], RATE, v[:, [j]], ratio[[j]])
        assert (together.cutoff[j], together.noise[j]) == (alone.cutoff[0], alone.noise[0])


def test_the_found_cutoff_is_near_the_one_that_estimates_acceleration_best():
    rng = np.random.default_rng(8)
    # Above half a hertz a motion whose fourth derivative is white.
    sections = signal.butter(4, 0.5, fs=RATE, output="sos")
    motion = signal.sosfilt(sections, rng.normal(size=(6000, 2)), axis=0)
    noisy = motion + np.array([1e-3, 1e-4]) * rng.normal(size=motion.shape)
    found = find_cutoffs(noisy, RATE)
    np.testing.assert_allclose(found.noise[0], 1e-3, rtol=0.1)
    assert found.cutoff[0] < found.cutoff[1]
    truth = derivatives(motion, RATE, 2)[1][INSIDE]

    def error(cutoff, j):
        low = smooth(noisy[:, [j]], RATE, cutoff)
        return np.std(derivatives(low, RATE, 2)[1][INSIDE] - truth[:, [j]])

    for j in range(2):
        best = min(error(f, j) for f in np.geomspace(2.0, 90.0, 30))
        assert error(found.cutoff[j], j) < 1.3 * best


@pytest.mark.parametrize("length", [9, 40, 400])
def test_a_cutoff_is_found_of_few_samples_at_a_high_rate(length):
    position = np.sin(np.linspace(0.0, 3.0, length))[:, None]
    slow, fast = (find_cutoffs(position, rate) for rate in (100.0, 2e5))
    np.testing.assert_allclose(fast.cutoff, 2e3 * slow.cutoff, rtol=1e-6 if length < 100 else 0.5)


@pytest.mark.parametrize("length", [200, 257, 900])
def test_power_density_is_the_one_of_scipy(length):
    x = np.cumsum(np.random.default_rng(1).normal(size=(900, 2)), axis=0)
    frequency, density = power_density(x, RATE, length)
    expected = signal.welch(x, RATE, nperseg=length, axis=0, detrend="linear")
    np.testing.assert_allclose(frequency, expected[0])
    np.testing.assert_allclose(density, expected[1], rtol=1e-9, atol=1e-14)


@pytest.mark.parametrize("cutoff", [1.0, 4.3, 10.0, 60.0])
def test_the_decimating_low_pass_is_the_one_of_scipy(cutoff):
    length, beta = signal.kaiserord(70.0, 0.5 * cutoff / (0.5 * RATE))
    taps = signal.firwin(length | 1, cutoff, window=("kaiser", beta), fs=RATE)
    np.testing.assert_allclose(design_decimator(RATE, cutoff).taps, taps / taps.sum(), atol=1e-14)


def test_reading_and_filtering_load_no_statistics():
    code = "import sys, jaxswarm.identify.predict; sys.exit('scipy.stats' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_a_velocity_that_belongs_to_another_motion_leaves_the_system_solvable():
    rng = np.random.default_rng(0)
    q = 5e4 * rng.normal(size=(400, 1))
    dq = np.cos(0.05 * np.arange(400))[:, None]
    found = find_cutoffs(q, 100.0, dq, np.array([1e12]))
    assert np.isfinite(found.cutoff).all() and np.isfinite(found.noise).all()


@pytest.mark.parametrize("cutoff", [3.0, 12.7, 200.0])
def test_a_position_that_stands_is_kept_to_the_last_digit(cutoff):
    stands = np.full((6000, 2), [1.2345, -2.7])
    np.testing.assert_allclose(smooth(stands, 1000.0, cutoff), stands, rtol=1e-15)
    velocity, ratio = np.zeros_like(stands), np.array([1e-6, 1e-4])
    kept = smooth(stands, 1000.0, cutoff, velocity, ratio)
    np.testing.assert_allclose(kept, stands, rtol=1e-15)
