"""From logs of known motion to position, velocity, acceleration and torque on the working clock."""

from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.logs import Log
from jaxswarm.logs.clock import with_sample_times
from jaxswarm.logs.filtering import derivatives
from jaxswarm.logs.motion import Filtering, prepare
from jaxswarm.logs.segments import prepare_segments
from jaxswarm.logs.smoothing import smooth
from jaxswarm.robot.load import load_robot
from jaxswarm.tasks.identifiable import identifiable

FREQUENCIES = (0.2, 0.5, 0.9, 1.4)


def analytic(t):
    """Two joints: position, velocity, acceleration at times t, (T, 2) each."""
    q = np.zeros((3, len(t), 2))
    for j in range(2):
        for k, f in enumerate(FREQUENCIES):
            w, a = 2 * np.pi * f, 0.3 / (1 + k + j)
            q[0, :, j] += a * np.sin(w * t + k + j)
            q[1, :, j] += a * w * np.cos(w * t + k + j)
            q[2, :, j] -= a * w**2 * np.sin(w * t + k + j)
    return q


def make_log(t, noise=0.0, **fields):
    q, dq, ddq = analytic(t)
    rng = np.random.default_rng(0)
    given = {"tau": 3.0 * ddq + 2.0 * dq + 1.0, **fields}
    return Log("made", ("joint1", "joint2"), t, q + noise * rng.normal(size=q.shape), **given)


def assert_close(found, expected, share, edge=0.0, t=None):
    """Error in the root mean square below a share of the signal's, ``edge`` seconds off the ends."""
    inside = slice(None) if t is None else (t > t[0] + edge) & (t < t[-1] - edge)
    error = np.sqrt(np.mean((found - expected)[inside] ** 2))
    assert error < share * np.sqrt(np.mean(expected**2)), error


def test_clean_motion_is_differentiated():
    t = np.arange(4000) / 200.0
    motion = prepare(make_log(t), Filtering(20.0, 10.0))
    q, dq, ddq = analytic(motion.t)
    assert_close(motion.q, q, 1e-5)
    assert_close(motion.dq, dq, 1e-4)
    assert_close(motion.ddq, ddq, 1e-3)
    assert np.abs(np.diff(motion.t) - 1 / motion.rate).max() < 1e-12


def test_noise_is_removed_with_frequencies_found_from_the_data():
    t = np.arange(6000) / 200.0
    motion = prepare(make_log(t, noise=1e-4))
    assert max(FREQUENCIES) < min(motion.motion_cutoff) <= max(motion.motion_cutoff) < 60.0
    assert motion.torque_cutoff < min(motion.motion_cutoff)
    ddq = analytic(motion.t)[2]
    assert_close(motion.ddq, ddq, 0.05, 0.5, motion.t)


@pytest.mark.parametrize("rate", [94.0, 1000.0, 5000.0])
def test_working_rate_holds_the_band(rate):
    t = np.arange(int(10 * rate)) / rate
    motion = prepare(make_log(t), Filtering(8.0, 5.0))
    assert 8 * 8.0 <= motion.rate * 1.001 or motion.rate == pytest.approx(rate)
    assert motion.rate <= rate * 1.0001
    assert_close(motion.ddq, analytic(motion.t)[2], 0.01, 0.3, motion.t)


def test_irregular_time_stamps_and_a_late_start():
    rng = np.random.default_rng(1)
    t = 100.0 + np.cumsum(rng.uniform(0.008, 0.012, 3000))
    motion = prepare(make_log(t), Filtering(10.0, 6.0))
    assert motion.t[0] == 0.0
    # Time is counted from the first sample, whose stamp is t[0].
    q, dq, ddq = analytic(motion.t + t[0])
    assert_close(motion.q, q, 1e-4)
    assert_close(motion.ddq, ddq, 0.01, 0.3, motion.t)
    assert_close(motion.tau, 3 * ddq + 2 * dq + 1, 0.01, 0.3, motion.t)


def test_torque_and_model_pass_the_same_low_pass():
    t = np.arange(4000) / 200.0
    motion = prepare(make_log(t), Filtering(20.0, 6.0))
    low = motion.decimator.apply
    model = 3.0 * motion.ddq + 2.0 * motion.dq + 1.0
    kept = motion.t[motion.decimator.kept(len(motion.t))]
    assert_close(low(motion.tau), low(model), 2e-3, 0.3, kept)


def test_a_cleaner_velocity_is_used_and_a_noisier_one_is_not():
    t = np.arange(4000) / 200.0
    dq = analytic(t)[1]
    rng = np.random.default_rng(2)
    good = prepare(make_log(t, 1e-3, dq=dq), Filtering(10.0, 6.0))
    without = prepare(make_log(t, 1e-3), Filtering(10.0, 6.0))
    bad = prepare(make_log(t, 1e-6, dq=dq + rng.normal(0, 0.5, dq.shape)), Filtering(10.0, 6.0))
    truth = analytic(good.t)[1]
    assert np.std(good.dq - truth) < 0.2 * np.std(without.dq - truth)
    assert np.std(bad.dq - truth) < 1e-3
    forced = prepare(make_log(t, 1e-3, dq=dq), Filtering(10.0, 6.0, use_logged_velocity=False))
    np.testing.assert_array_equal(forced.dq, without.dq)


def test_a_logged_acceleration_is_used():
    t = np.arange(2000) / 200.0
    ddq = analytic(t)[2]
    motion = prepare(make_log(t, 1e-3, ddq=ddq), Filtering(10.0, 6.0))
    assert_close(motion.ddq, analytic(motion.t)[2], 1e-3, 0.3, motion.t)


def test_channels_follow_the_clock():
    t = np.arange(4000) / 1000.0
    motion = prepare(
        make_log(t, channels={"temperature": np.stack([t, 20 + t], 1)}), Filtering(5.0)
    )
    np.testing.assert_allclose(motion.channels["temperature"][:, 1], 20 + motion.t, atol=1e-9)


def test_the_temperature_of_a_room_is_no_joint_s():
    """Laws read one column a joint; a log with one column for all ended in an IndexError."""
    t = np.arange(4000) / 1000.0
    log = make_log(t, channels={"temperature": 20.0 + t})
    assert prepare(log, Filtering(5.0)).channels == {}
    paused = replace(log, t=np.where(t < 2.0, t, t + 60.0))
    _, motions = prepare_segments(paused, Filtering(5.0))
    assert len(motions) == 2 and not any(motion.channels for motion in motions)
    arm = load_robot("rx60")
    three = replace(
        log, joints=arm.joints, q=log.q[:, [0, 1, 0]], dq=None, tau=log.tau[:, [0, 1, 0]]
    )
    assert identifiable(arm, [prepare(three, Filtering(5.0))])["base_parameters"]


def test_a_log_without_torque_has_none():
    motion = prepare(make_log(np.arange(400) / 200.0, tau=None), Filtering(10.0))
    assert motion.tau is None


@pytest.mark.parametrize("length", [1, 2, 5, 19])
def test_short_logs_are_refused(length):
    with pytest.raises(InputError, match=f"{length} samples are too few"):
        prepare(make_log(np.arange(length) / 100.0))


@pytest.mark.parametrize("length", [20, 21, 40])
def test_barely_long_enough_logs_are_finite(length):
    motion = prepare(make_log(np.arange(length) / 100.0))
    for x in (motion.q, motion.dq, motion.ddq, motion.tau):
        assert np.isfinite(x).all()
    assert len(motion.decimator.apply(motion.tau)) >= 10


@pytest.mark.parametrize("cutoff", [-1.0, 150.0])
def test_torque_cutoff_outside_the_band_is_refused(cutoff):
    with pytest.raises(InputError, match="torque cutoff"):
        prepare(make_log(np.arange(400) / 200.0), Filtering(10.0, cutoff))


def test_stamps_that_jitter_about_even_samples_are_seen_through():
    rng = np.random.default_rng(4)
    even = np.arange(4000) / 200.0
    stamps = even + rng.uniform(-1e-3, 1e-3, len(even))
    written_late = make_log(even, 1e-5)
    seen_through = with_sample_times(replace(written_late, t=stamps))
    assert "jitter" in seen_through.notes[-1]
    np.testing.assert_allclose(seen_through.t, even, atol=1e-4)
    # Samples that were really taken unevenly keep their stamps.
    taken_so = make_log(stamps, 1e-5)
    assert with_sample_times(taken_so) is taken_so
    assert with_sample_times(written_late) is written_late


def test_a_slow_joint_is_differentiated_alike_at_any_rate():
    """Sampled often, as beside a fast neighbor, its smoothing lost its digits: 270 times the error."""

    def error(rate):
        t, rng = np.arange(int(12 * rate)) / rate, np.random.default_rng(0)
        w = 2 * np.pi * np.array([0.15, 0.35])
        noise = 2e-6 * np.sqrt(rate / 100.0) * rng.normal(size=len(t))
        low = smooth(np.sin(np.outer(t, w)).sum(axis=1) + noise, rate, 6.0)
        off = derivatives(low, rate, 2)[1] + np.sin(np.outer(t, w)) @ w**2
        return np.std(off[(t > 0.5) & (t < 11.5)])

    assert max(error(1000.0), error(4000.0)) < 2.0 * error(100.0)
