"""Pauses are boundaries, bursts are averaged, and the working clock never outgrows the samples."""

from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.identify import estimate
from jaxswarm.identify.estimation.validate import log_errors
from jaxswarm.identify.forward.regression import build_regression
from jaxswarm.logs import Log, read_log, write_log
from jaxswarm.logs.log import take
from jaxswarm.logs.motion import Filtering, prepare
from jaxswarm.logs.resampling import TooShort
from jaxswarm.logs.segments import merge_bursts, prepare_segments, split_at_gaps
from jaxswarm.logs.spikes import bridged, find_spikes
from jaxswarm.plots import torque_overlay
from jaxswarm.robot import load_robot

W = 2 * np.pi * np.array([0.4, 1.1])


def moving(t, noise=1e-5, name="made"):
    """One joint in steady motion with a torque that follows from it."""
    w = 2 * np.pi * np.array([0.4, 1.1])
    q = np.sin(np.outer(t, w)).sum(axis=1)
    ddq = -(w**2 * np.sin(np.outer(t, w))).sum(axis=1)
    rng = np.random.default_rng(0)
    return Log(
        name, ("joint1",), t, (q + noise * rng.normal(size=len(t)))[:, None], tau=ddq[:, None]
    )


def exact(t):
    w = 2 * np.pi * np.array([0.4, 1.1])
    return -(w**2 * np.sin(np.outer(t, w))).sum(axis=1)


@pytest.mark.parametrize("pause", [2.0, 10.0, 100.0, 500.0])
def test_a_pause_is_no_motion(pause):
    t = np.arange(4000) * 0.01
    whole = moving(t)
    shifted = np.where(t < 20.0, t, t + pause)
    log = Log("made", whole.joints, shifted, whole.q, tau=whole.tau)
    parts = split_at_gaps(log)
    assert [len(part.t) for part in parts] == [2000, 2000]
    noted, motions = prepare_segments(log)
    assert "Split at 1 gap" in noted.notes[-1]
    assert len({(m.motion_cutoff, m.torque_cutoff) for m in motions}) == 1
    assert sum(len(m.t) for m in motions) <= len(t)
    for motion, start in zip(motions, (0.0, 20.0 + pause), strict=True):
        assert motion.t[0] == pytest.approx(start, abs=1e-6)
        inside = slice(len(motion.t) // 10, -len(motion.t) // 10)
        true = exact(motion.t - (pause if start else 0.0))
        assert np.abs(motion.ddq[inside, 0] - true[inside]).max() < 0.02 * np.abs(true).max()


def test_lost_samples_are_bridged():
    keep = np.random.default_rng(1).random(4000) > 0.2
    log = take(moving(np.arange(4000) * 0.005), keep)
    assert len(split_at_gaps(log)) == 1
    (motion,) = prepare_segments(log)[1]
    assert np.abs(motion.ddq[200:-200, 0] - exact(motion.t + log.t[0])[200:-200]).max() < 2.0


def test_short_parts_are_left_out_with_a_note():
    t = np.concatenate([np.arange(3000), np.arange(3500, 3515), np.arange(4000, 7000)]) * 0.01
    noted, motions = prepare_segments(moving(t))
    assert len(motions) == 2
    assert any("too short" in note and "35 to 35.14 s" in note for note in noted.notes)


def test_nothing_but_short_parts_is_refused():
    t = (np.arange(20)[:, None] * 2.0 + np.arange(15) * 0.01).ravel()
    with pytest.raises(InputError, match="20 parts"):
        prepare_segments(moving(t))


@pytest.mark.parametrize("size", [2, 5, 20])
def test_bursts_do_not_set_the_clock(size):
    count = 5000 // size
    stamps = (np.arange(count)[:, None] * 0.001 * size + np.arange(size) * 1e-6).ravel()
    log = moving(stamps)
    merged = merge_bursts(log)
    assert len(merged.t) == count
    assert "stamped together" in merged.notes[-1]
    (motion,) = prepare_segments(log)[1]
    assert len(motion.t) <= len(stamps)
    inside = slice(len(motion.t) // 10, -len(motion.t) // 10)
    assert np.abs(motion.ddq[inside, 0] - exact(motion.t)[inside]).max() < 0.1 * 30


@pytest.mark.parametrize("stamps", ["regular", "jitter", "bursts", "lost", "pairs", "pauses"])
def test_the_clock_never_has_many_times_more_points_than_samples(stamps):
    rng = np.random.default_rng(3)
    t = np.arange(3000) * 0.01
    t = {
        "regular": t,
        "jitter": t + 0.004 * rng.random(3000),
        "bursts": np.sort(t + 0.0099 * (rng.random(3000) < 0.5)) + np.arange(3000) * 1e-7,
        "lost": t[rng.random(3000) > 0.5],
        "pairs": np.sort(np.concatenate([t[::2], t[::2] + 2e-6])),
        "pauses": t + np.cumsum(3.0 * (rng.random(3000) < 0.002)),
    }[stamps]
    noted, motions = prepare_segments(moving(t), Filtering(10.0, 5.0))
    assert sum(len(m.t) for m in motions) < 2 * len(t)
    assert all(np.isfinite(m.ddq).all() for m in motions)


def test_a_log_without_gaps_is_prepared_as_before():
    log = moving(np.arange(2000) * 0.01)
    (motion,) = prepare_segments(log)[1]
    alone = prepare(log)
    assert np.array_equal(motion.q, alone.q) and np.array_equal(motion.t, alone.t)


def test_too_short_for_slow_motion_is_said():
    t = np.arange(30) * 1e-3
    with pytest.raises(TooShort, match="too short for motion below 0.5 Hz"):
        prepare(moving(t), Filtering(0.5, 0.3))


def test_bursts_pass_the_checks_of_the_reader(tmp_path):
    stamps = (np.arange(200)[:, None] * 0.01 + np.arange(8) * 2e-6).ravel()
    write_log(moving(stamps), tmp_path / "log.csv")
    assert len(read_log(tmp_path / "log.csv", ("joint1",)).t) == len(stamps)


def with_gaps(log, count, shortest, longest):
    """The log with so many stretches of time cut out of it, evenly placed."""
    rng, keep = np.random.default_rng(5), np.ones(len(log.t), dtype=bool)
    each = (log.t[-1] - log.t[0]) / count
    for k in range(count):
        start, length = (k + rng.uniform(0.3, 0.6)) * each, rng.uniform(shortest, longest)
        keep &= ~((log.t > start) & (log.t < start + length))
    return take(log, keep)


@pytest.mark.parametrize("velocity", [False, True])
def test_gaps_short_against_the_motion_are_bridged_and_left_out(velocity):
    t = np.arange(2000) * 0.02
    log = moving(t, 1e-4)
    if velocity:
        rng = np.random.default_rng(1)
        speed = np.gradient(np.sin(np.outer(t, W)).sum(axis=1), t) + 1e-3 * rng.normal(size=len(t))
        log = replace(log, dq=speed[:, None])
    whole = prepare(log)
    noted, motions = prepare_segments(with_gaps(log, 16, 0.12, 0.2))
    (motion,) = motions
    assert "16 gaps of up to 0.2" in noted.notes[-1]
    assert f"{motion.lost_rows.sum()} of {len(motion.lost_rows)} rows" in noted.notes[-1]
    assert 0.1 < motion.lost_rows.mean() < 0.6
    # The band is that of the log without gaps, and so is the motion in all rows that are kept.
    assert motion.motion_cutoff[0] == pytest.approx(whole.motion_cutoff[0], rel=0.15)
    off = motion.decimator.apply(motion.ddq - exact(motion.t)[:, None])[~motion.lost_rows]
    assert np.sqrt(np.mean(off**2)) < 2e-3 * np.sqrt(np.mean(whole.ddq**2))
    # No fit and no score sees what was put in.
    robot = load_robot("emps")
    model = estimate(robot, (), [motion]).model
    assert np.array_equal(
        ~build_regression(robot, (), [motion], (0.1,)).used_rows[:, 0], motion.lost_rows
    )
    spoiled = replace(motion, tau=np.where(motion.lost[:, None], 100.0, motion.tau))
    errors = [log_errors(model, m)["wideband"]["rms"] for m in (motion, spoiled)]
    assert errors[0] == errors[1]
    # No picture shows it as measured.
    assert np.array_equal(np.isnan(motion.known_torque[:, 0]), motion.lost_rows)
    t, nothing = motion.t[motion.decimator.kept(len(motion.t))], 0.0 * motion.low_torque
    figure = torque_overlay(t, motion.known_torque, nothing, ["a"], ["N"])
    rms = np.sqrt(np.mean(motion.low_torque[~motion.lost_rows] ** 2))
    assert figure.axes[1].texts[0].get_text() == f"RMS {rms:.3g} N"


def test_gaps_long_against_the_motion_cut_the_log():
    log = with_gaps(moving(np.arange(2000) * 0.02), 4, 0.5, 0.8)
    noted, motions = prepare_segments(log)
    assert any("Split at 4 gaps" in note for note in noted.notes)
    assert all(m.lost is None for m in motions)


def test_the_sample_after_a_gap_in_which_a_joint_turned_is_no_spike():
    t = np.arange(200) * 0.02
    q = -((t - 1.0) ** 2) + 1e-6 * np.random.default_rng(0).normal(size=200)
    log = take(Log("made", ("joint1",), t, q[:, None]), (t < 0.91) | (t > 1.07))
    assert find_spikes(log.q[:, 0]).any()
    mended, found = bridged(log)
    assert not found and np.array_equal(mended.q, log.q)
