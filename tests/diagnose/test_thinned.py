"""A link behind its motor is tried on as many samples of a fast log as it takes, with the same torque."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from jaxswarm.diagnose.candidates import link_lag
from jaxswarm.diagnose.candidates.link_lag import lag_torque
from jaxswarm.diagnose.candidates.thinned import (
    SparseDecimator,
    interval_of,
    thinned,
    usual_inertia,
)
from jaxswarm.identify.forward import columns, sensitivity
from jaxswarm.identify.forward.sensitivity import Sensitivity
from jaxswarm.identify.synthetic import random_links, synthetic_log
from jaxswarm.logs.filtering import Decimator, design_decimator
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import load_robot

GAPS = np.array([0.0, 0.0, 0.003, 0.01])


@pytest.fixture(scope="module")
def fast():
    """An arm at 1 kHz, with its parameters."""
    robot = load_robot("rx60")
    robot = robot.replace(parameters=random_links(robot, np.random.default_rng(0)))
    slow = prepare(synthetic_log(robot, (), 0, duration=6.0))
    t = np.arange(0.0, slow.t[-1], 1e-3)
    q, dq, ddq, tau = (
        scipy.interpolate.CubicSpline(slow.t, x)(t) for x in (slow.q, slow.dq, slow.ddq, slow.tau)
    )
    low = design_decimator(1000.0, 7.0)
    assert low.factor % 4  # rows that begin between the samples that are kept
    motion = replace(slow, t=t, q=q, dq=dq, ddq=ddq, tau=tau, decimator=low, torque_cutoff=7.0)
    return robot, motion, np.asarray(robot.parameters).ravel()


def lags(motion, sensed, pi):
    inertia = np.median(np.abs(sensed.inertia(pi)))
    k = inertia * (2 * np.pi * np.array([15.0, 60.0, 40.0, 40.0])) ** 2
    return lag_torque(motion, sensed, pi[None], k, 0.01 * k, GAPS, np.zeros(4))


def test_a_lag_tried_on_fewer_samples_changes_the_same_torque(fast, monkeypatch):
    robot, motion, pi = fast
    few = lags(motion, Sensitivity(robot, motion, 2), pi)
    monkeypatch.setattr(link_lag, "thinned", lambda *whole: whole)
    every = lags(motion, Sensitivity(robot, motion, 2), pi)
    assert few.shape == every.shape
    off = np.sqrt(np.square(few - every).sum(axis=(1, 2)) / np.square(every).sum(axis=(1, 2)))
    assert (off < [0.01, 0.01, 0.1, 0.1]).all(), off


def test_a_fast_log_is_integrated_on_a_quarter_of_its_samples(fast, monkeypatch):
    """At 1 kHz five joints' candidates took 22 s a round, at 250 Hz a quarter of that."""
    robot, motion, pi = fast
    seen, swings = [], link_lag.swings
    monkeypatch.setattr(link_lag, "swings", lambda m, *at: seen.append(m) or swings(m, *at))
    sensed = Sensitivity(robot, motion, 2)
    lags(motion, sensed, pi)
    (few,) = seen
    assert few.rate == pytest.approx(250.0)
    assert thinned(motion, sensed)[1] is thinned(motion, sensed)[1]  # averaged once
    for whole in (replace(motion, t=4.0 * motion.t), replace(motion, torque_cutoff=60.0)):
        assert thinned(whole, sensed)[0] is whole  # at 250 Hz, or compared that far


def test_a_log_whose_few_samples_alone_can_be_kept_is_tried_on_these(fast, monkeypatch):
    """Seven joints at 1 kHz for 30 s, 1.4 times what is kept, took 318 s for 106: all samples, each option."""
    robot, motion, pi = fast
    kept = lags(motion, Sensitivity(robot, motion, 2), pi)
    few = thinned(motion, Sensitivity(robot, motion, 2))[1]
    monkeypatch.setattr(columns, "_KEPT", columns.numbers_of(motion) // 2)
    monkeypatch.setattr(sensitivity, "BLOCK", 250)
    sensed = Sensitivity(robot, motion, 2)
    assert not columns.is_kept(motion) and interval_of(motion) == 4
    parts = thinned(motion, sensed)[1]
    for one, other in zip(few._whole, parts._whole, strict=True):
        np.testing.assert_allclose(other, one, rtol=1e-12, atol=1e-12 * np.abs(one).max())
    told = usual_inertia(sensed, pi)
    assert told == pytest.approx(np.median(np.abs(sensed.inertia(pi))), rel=0.01)
    # Gears are as stiff as the inertia on few samples asks for.
    np.testing.assert_allclose(
        lags(motion, sensed, pi), kept, rtol=1e-9, atol=1e-9 * np.abs(kept).max()
    )
    monkeypatch.setattr(columns, "_KEPT", columns.numbers_of(motion) // 5)
    assert interval_of(motion) == 1 and thinned(motion, sensed)[0] is motion


@pytest.mark.parametrize("factor", [11, 14, 16])
def test_rows_from_few_samples_are_those_of_all(factor):
    rng = np.random.default_rng(0)
    t = np.arange(1500.0)
    x = np.stack([np.sin(w * t) for w in rng.uniform(0.01, 0.1, 6)], axis=1).reshape(-1, 2, 3)
    low = Decimator(design_decimator(1000.0, 20.0).taps, factor)
    few = SparseDecimator(low.taps, factor, 4)
    told = low.apply(x)
    given = x[: 4 * few.given(len(told)) : 4]
    np.testing.assert_allclose(few.apply(given), told, atol=2e-4)
    parts = [few.apply(given[part]) for part in few.blocks(len(given), 120)]
    assert len(parts) > 2
    np.testing.assert_allclose(np.concatenate(parts), few.apply(given), atol=1e-12)
    at = 4 * few.kept(len(given))
    assert len(at) == len(told) and np.abs(at - low.kept(len(x))).max() <= 2
