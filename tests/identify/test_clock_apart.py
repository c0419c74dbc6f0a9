"""Torques that are all late or early by more than a delay of an arm are told, with the time."""

from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.identify.checks.check_log import against_robot
from jaxswarm.identify.checks.clock_apart import shifted
from jaxswarm.identify.checks.samples import samples_of
from jaxswarm.logs.motion import Filtering
from jaxswarm.logs.segments import prepare_segments


def motions(log):
    return prepare_segments(log, Filtering(torque_cutoff=5.0))[1]


def late(log, seconds):
    tau = np.stack([np.interp(log.t - seconds, log.t, x) for x in log.tau.T], axis=1)
    return replace(log, tau=tau)


@pytest.mark.parametrize("seconds", [0.1, -0.1, 0.4])
def test_the_time_by_which_all_torques_are_apart_is_told(arm, log, seconds):
    finding, *_ = against_robot(arm, motions(late(log, seconds)))
    assert finding.check == "late_torque" and finding.refused
    side = "late" if seconds > 0 else "early"
    told, rest = finding.what.removeprefix("all torques are ").split(" s ", 1)
    assert rest.startswith(side) and float(told) == pytest.approx(abs(seconds), abs=0.01)
    assert f"Move the torques by {-np.sign(seconds) * float(told):.2f} s" in finding.remedy


@pytest.mark.parametrize("seconds", [0.04, -0.04])
def test_a_delay_that_a_model_takes_is_left_to_it(arm, log, seconds):
    assert against_robot(arm, motions(late(log, seconds))) == []


def test_a_log_whose_torques_pass_a_filter_is_not_refused(arm, log):
    step = float(np.median(np.diff(log.t)))
    tau = log.tau.copy()
    for before, here in zip(tau, tau[1:], strict=False):
        here += (before - here) * np.exp(-step / 0.1)
    finding, *_ = against_robot(arm, motions(replace(log, tau=tau)))
    assert finding.check == "late_torque" and not finding.refused
    assert "or pass a filter" in finding.what


def test_torques_of_two_stretches_are_not_joined(log):
    samples = samples_of(motions(log))
    rows = np.arange(len(samples.t))
    last = len(rows) // 2 - 1
    parted = replace(samples, t=samples.t + 5.0 * (rows > last))
    moved = shifted(parted, 2.5 * float(np.median(np.diff(samples.t))))
    assert len(moved.t) == len(samples.t) - 6
    np.testing.assert_allclose(shifted(parted, 0.0).tau, np.delete(samples.tau, last, axis=0))
