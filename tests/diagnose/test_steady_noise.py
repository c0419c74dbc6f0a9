"""Noise of the torque that is stronger the slower it is, told from what a law leaves above the band."""

from dataclasses import replace

import numpy as np
import pytest
import scipy
from planted import BAND, DECLARED, blank, small_arm

from jaxswarm.diagnose.decision.remainder import remainders
from jaxswarm.diagnose.folds import steady
from jaxswarm.diagnose.folds.noise import noise_of, with_motion_noise
from jaxswarm.diagnose.folds.steady import steady_powers, with_steady_noise
from jaxswarm.identify import estimate
from jaxswarm.identify.forward.model import model_torque
from jaxswarm.identify.synthetic import Noise, synthetic_log
from jaxswarm.logs.motion import Filtering, prepare

RATE, CUTOFF, SIZE = 250.0, 8.0, 1.0


def noise(seed=0, alike=0.0, length=6000):
    drawn = np.random.default_rng(seed).normal(size=(length, 1))
    size = SIZE * np.sqrt(1.0 - alike**2)
    return scipy.signal.lfilter([size], [1.0, -alike], drawn, axis=0)


def of_white(left):
    """Power over that of white noise of the same size."""
    return steady_powers(left, RATE, CUTOFF).above / (SIZE**2 * CUTOFF / (0.5 * RATE))


def test_white_noise_has_its_power():
    got = np.array([of_white(noise(seed)) for seed in range(40)])
    assert abs(got.mean() - 1.0) < 0.05
    assert got.std() < 0.25


def test_what_comes_in_bursts_or_in_a_line_is_not_taken_for_noise():
    t = np.arange(6000) / RATE
    burst = np.where((t % 4.0 < 0.7), 4.0, 0.0) * np.sin(2 * np.pi * 17.0 * t + 40.0 * t**2)
    line = np.sin(2 * np.pi * 16.0 * t)
    plain = of_white(noise())
    for more, most in ((burst, 1.5), (line, 2.5)):
        left = noise() + more[:, None]
        assert of_white(left) < most * plain


def of_first_order(corner, rate, seed, seconds=24.0):
    """Noise (T, 1) of a filter of first order with a corner [Hz], of unit size before it."""
    alike = np.exp(-2.0 * np.pi * corner / rate)
    drawn = np.random.default_rng(seed).normal(size=(round(seconds * rate), 1))
    return scipy.signal.lfilter([1.0 - alike], [1.0, -alike], drawn, axis=0)


@pytest.mark.parametrize(
    ("rate", "cutoff", "corner"), [(50.0, 8.0, 3.0), (100.0, 17.0, 10.0), (500.0, 86.0, 30.0)]
)
def test_noise_whose_corner_lies_within_the_band_is_told_from_the_band(rate, cutoff, corner):
    """The octave above it is not sampled."""
    low = scipy.signal.butter(4, cutoff, fs=rate, output="sos")
    told, true = [], []
    for seed in range(20):
        left = of_first_order(corner, rate, seed)
        told.append(steady_powers(left, rate, cutoff).within[0])
        true.append((scipy.signal.sosfiltfilt(low, left, axis=0) ** 2).mean())
    assert 0.75 < np.median(told) / np.mean(true) < 1.25


@pytest.mark.parametrize("corner", [6.0, 10.0, 15.0])
def test_noise_with_its_corner_near_the_edge_of_the_band_is_told_by_all_octaves(corner):
    """By the band's two octaves alone half of the size was told of a quarter of such logs."""
    low = scipy.signal.butter(4, 10.0, fs=RATE, output="sos")
    logs = np.hstack([of_first_order(corner, RATE, seed, 16.0) for seed in range(60)])
    true = (scipy.signal.sosfiltfilt(low, logs, axis=0) ** 2).mean()
    told = np.sqrt(steady_powers(logs, RATE, 10.0).within / true)
    assert 0.95 < np.median(told) < 1.1
    assert np.mean(told < 0.75) <= 0.1 and np.mean(told > 1.3) <= 0.05


def test_rows_that_are_left_out_of_the_fit_tell_nothing():
    """A joint that dry friction held in a third of a log had no noise within the band, and half of it above."""
    left, out = of_first_order(12.0, RATE, 0, 40.0), np.zeros((10000, 1), dtype=bool)
    clean = steady_powers(left, RATE, 10.0)
    for begin in range(500, 10000, 1500):
        out[begin : begin + 500] = True
    stuck = left + 5.0 * out * np.random.default_rng(1).normal(size=left.shape)
    whole, fitted = (steady_powers(stuck, RATE, 10.0, rows) for rows in (None, out))
    assert whole.within > 2.0 * clean.within or whole.within == 0.0
    assert 0.7 < fitted.within / clean.within < 1.4 and 0.7 < fitted.above / clean.above < 1.4


def test_a_row_left_out_is_the_samples_around_it():
    log = synthetic_log(small_arm(), DECLARED, 1, duration=8.0, rate=RATE)
    motion = prepare(log, BAND)
    kept = motion.decimator.kept(len(motion.t))
    assert steady._not_fitted(motion) is None
    held = np.zeros((len(kept), 2), dtype=bool)
    held[[0, 20, -1], 0] = True
    out = steady._not_fitted(replace(motion, held=held))
    np.testing.assert_array_equal(out[kept], held)
    assert out[: kept[0], 0].all() and out[kept[-1] :, 0].all() and not out[:, 1].any()
    assert out[:, 0].sum() < kept[0] + (len(out) - kept[-1]) + 3 * motion.decimator.factor


def test_what_a_law_leaves_within_the_band_is_not_taken_for_noise():
    """A spring's torque along smooth motion, and steps at its reversals, beside noise of a twentieth."""
    t = np.arange(2400) / 100.0
    q = np.sin(0.9 * t) + 0.6 * np.sin(2.3 * t + 1.0) + 0.3 * np.sin(5.1 * t)
    little = 0.05 * noise(length=2400)
    alone = steady_powers(little, 100.0, 17.0).within
    for left in (q, np.sign(np.gradient(q))):
        told = steady_powers(left[:, None] + little, 100.0, 17.0).within
        assert told < 4.0 * alone  # of 400 times as much


def test_what_rises_faster_than_such_noise_does_is_counted_flat():
    slow = scipy.signal.lfilter([0.1], [1.0, -0.9], of_first_order(1.0, 100.0, 0, 40.0), axis=0)
    low = scipy.signal.butter(4, 17.0, fs=100.0, output="sos")
    true = (scipy.signal.sosfiltfilt(low, slow, axis=0) ** 2).mean()
    assert steady_powers(slow, 100.0, 17.0).within < 0.1 * true


def test_too_short_a_log_tells_nothing_and_does_not_silence_another():
    told = steady_powers(noise(length=400), RATE, CUTOFF)
    assert np.isnan(told.above).all() and np.isnan(told.within).all() and np.isinf(told.most).all()
    assert steady_powers(noise(), RATE, 40.0).above == 0.0
    log = synthetic_log(small_arm(), DECLARED, 1, noise=Noise(2e-5, 0.0), duration=24.0, rate=RATE)
    slow = 0.1 * np.hstack([noise(seed, 0.6, len(log.t)) for seed in (1, 2)])
    log = replace(log, tau=log.tau + slow)
    motion = prepare(log, BAND)
    found = with_motion_noise(estimate(small_arm(), blank(), [motion, motion], bounded=False))
    short = replace(found.motions[0], steady_noise=np.full(2, np.nan))
    beside = replace(found, motions=(short, found.motions[1]))
    np.testing.assert_array_equal(noise_of(beside), noise_of(found))


def test_a_clean_log_whose_noise_has_memory_is_near_its_noise():
    log = synthetic_log(small_arm(), DECLARED, 1, noise=Noise(2e-5, 0.0), duration=24.0, rate=RATE)
    slow = 0.1 * np.hstack([noise(seed, 0.6, len(log.t)) for seed in (1, 2)])
    log = replace(log, tau=log.tau + slow)
    found = with_motion_noise(estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False))
    motion = found.motions[0]
    assert (found.fit.sigma > 2.5 * motion.torque_noise).all()
    assert (found.fit.sigma < 1.7 * noise_of(found)).all()
    assert all(r.near for r in remainders(found))


@pytest.mark.parametrize("rate", [50.0, 100.0])
def test_a_clean_log_whose_noise_has_its_corner_within_the_band_is_near_its_noise(rate):
    """The octave above the band is not sampled."""
    log = synthetic_log(small_arm(), DECLARED, 1, noise=Noise(2e-5, 0.0), duration=24.0, rate=rate)
    slow = np.hstack([of_first_order(0.06 * rate, rate, seed) for seed in (1, 2)])
    log = replace(log, tau=log.tau + 0.3 * slow[: len(log.t)])
    wide = prepare(log, Filtering(torque_cutoff=0.17 * rate))
    found = with_motion_noise(estimate(small_arm(), blank(), [wide], bounded=False))
    motion = found.motions[0]
    assert (found.fit.sigma > 1.7 * motion.torque_noise).all()
    assert all(r.over_noise < 1.25 for r in remainders(found))


def test_white_noise_is_told_from_above_the_band_alone():
    log = synthetic_log(small_arm(), DECLARED, 1, noise=Noise(2e-5, 0.1), duration=24.0, rate=RATE)
    found = with_motion_noise(estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False))
    (motion,) = found.motions
    left = motion.tau - np.asarray(model_torque(found.model, motion))
    most = steady_powers(left, motion.rate, motion.torque_cutoff).above
    assert (motion.steady_noise**2 <= most).all()


def jitter(length, seed=0):
    """Noise (length, 2) of unit size, the stronger the faster it is, as of a drive on coarse positions."""
    drawn = np.random.default_rng(seed).normal(size=(length + 3, 2))
    return np.diff(drawn, 3, axis=0) / np.sqrt(20.0)


@pytest.mark.parametrize("share", [1.0, 0.1])
def test_jitter_near_half_the_rate_is_no_noise_of_the_band(share):
    """Such logs were left with a tenth of what was told as their noise, and effects of its size not seen."""
    log = synthetic_log(small_arm(), DECLARED, 1, noise=Noise(2e-5, 0.03), duration=24.0, rate=RATE)
    log = replace(log, tau=log.tau + share * jitter(len(log.t)))
    found = with_motion_noise(estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False))
    (motion,) = found.motions
    assert (found.fit.sigma < 0.35 * motion.torque_noise).all()
    assert all(0.5 < r.over_noise < 1.3 for r in remainders(found))


def test_what_a_law_leaves_beside_jitter_stands_out():
    log = synthetic_log(small_arm(), DECLARED, 1, noise=Noise(2e-5, 0.03), duration=24.0, rate=RATE)
    more = jitter(len(log.t)) + 0.1 * np.sin(11.0 * log.q)
    log = replace(log, tau=log.tau + more)
    found = with_motion_noise(estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False))
    assert all(r.over_noise > 2.0 for r in remainders(found))


def test_what_shakes_just_above_the_band_is_no_noise_of_the_band():
    """A loop that rings there was told as three times the noise."""
    above = scipy.signal.butter(4, (13.0, 22.0), "bandpass", fs=RATE, output="sos")
    left = noise() + 4.0 * scipy.signal.sosfiltfilt(above, noise(1), axis=0)
    log = synthetic_log(small_arm(), DECLARED, 1, noise=Noise(2e-5, 0.03), duration=24.0, rate=RATE)
    motion = replace(prepare(log, BAND), torque_cutoff=CUTOFF, torque_noise=np.full(1, 0.25))
    told = with_steady_noise(motion, left, [])
    assert steady_powers(left, motion.rate, CUTOFF).above > 4.0 * told.steady_noise**2


def test_the_bound_of_white_noise_is_not_below_it():
    low = [steady_powers(noise(seed), RATE, CUTOFF).most for seed in range(100)]
    white = SIZE**2 * CUTOFF / (0.5 * RATE)
    assert 0.8 < np.median(low) / white < 1.1
    assert np.min(low) > white / 1.5**2


def test_jitter_far_above_the_band_is_not_sharp():
    """Of a drive that holds its torque for two samples differences tell little, and the power above it all."""
    log = synthetic_log(small_arm(), DECLARED, 1, noise=Noise(2e-5, 0.03), duration=24.0, rate=RATE)
    far = scipy.signal.butter(4, (45.0, 75.0), "bandpass", fs=RATE, output="sos")
    wave = np.hstack([noise(seed, length=len(log.t)) for seed in (1, 2)])
    log = replace(log, tau=log.tau + scipy.signal.sosfiltfilt(far, wave, axis=0))
    found = with_motion_noise(estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False))
    sharp = np.sqrt((found.motions[0].sharp_noise ** 2).mean(axis=0))
    assert (sharp < 3.0 * found.fit.sigma).all()  # 8 and 12 times by all that is above
