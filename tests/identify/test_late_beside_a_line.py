"""What pushes a joint looks late at one frequency, what sticks at rest alone, a late torque always."""

from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.identify.checks.check_log import against_robot
from jaxswarm.identify.checks.late import _IN_MOTION
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.rough_columns import strongest_line
from jaxswarm.identify.checks.samples import samples_of
from jaxswarm.identify.synthetic import Noise, fourier_motion, random_links, synthetic_log
from jaxswarm.logs.motion import Filtering
from jaxswarm.logs.segments import prepare_segments
from jaxswarm.robot.load import load_robot

RATE, HERTZ, JOINT, FORCE, SWING = 125.0, 2.2, 2, 4.0, 0.05


@pytest.fixture(scope="module")
def arm():
    bare = load_robot("ur10e")
    return bare.replace(parameters=random_links(bare, np.random.default_rng(0), mass=20.0))


def told(arm, log):
    return [one.check for one in against_robot(arm, prepare_segments(log, Filtering())[1])]


def pushed(arm, phase):
    """A log of a joint that a force pushes and whose drive, soft at that frequency, lets it give way."""
    t, q, dq, ddq = fourier_motion(arm.num_joints, np.random.default_rng(3), 20.0, RATE)
    there, omega = np.arange(arm.num_joints) == JOINT, 2 * np.pi * HERTZ
    wave, slope = (SWING * there * f(omega * t + phase)[:, None] for f in (np.sin, np.cos))
    moved = t, q + wave, dq + omega * slope, ddq - omega**2 * wave
    log = synthetic_log(arm, (), 3, noise=Noise(2e-5, 0.05), rate=RATE, moved=moved)
    return replace(log, tau=log.tau + FORCE * there * np.sin(omega * t)[:, None])


def late(log, joint):
    tau = log.tau.copy()
    tau[:, joint] = np.interp(log.t - 0.02, log.t, tau[:, joint])
    return replace(log, tau=tau)


@pytest.mark.parametrize("phase", [0.5 * np.pi, 1.5 * np.pi])
def test_a_joint_that_is_pushed_to_and_fro_has_no_late_torque(arm, phase):
    """It looks 11 ms early or late, by four tenths of what is left, as steadily as a torque that is."""
    assert told(arm, pushed(arm, phase)) == []


@pytest.mark.parametrize("joint", [0, JOINT])
def test_a_late_torque_is_told_beside_such_a_force(arm, joint):
    assert told(arm, late(pushed(arm, 0.0), joint)) == ["late_torque"]


@pytest.mark.parametrize("hertz", [0.11, 2.53, 9.0])
def test_the_strongest_line_of_a_log_with_a_gap(hertz):
    t = 0.02 * np.delete(np.arange(1000), np.s_[300:450])
    noise = np.random.default_rng(0).normal(size=len(t))
    assert abs(strongest_line(t, np.sin(2 * np.pi * hertz * t + 1.0) + noise) - hertz) < 0.02


def rough_of(arm, log):
    """The rough model of a log, and the spread that its residuals are weighed by."""
    model = Rough(arm, samples_of(prepare_segments(log, Filtering())[1]))
    return model, model.as_logged()[1]


def test_a_torque_that_runs_ahead_where_its_joint_sticks_alone_is_early_at_rest_alone(arm):
    log = synthetic_log(arm, (), 3, noise=Noise(2e-5, 0.05), rate=RATE, duration=20.0)
    speed = np.gradient(log.q[:, JOINT], log.t)
    stuck = np.abs(speed) < 0.02 * np.sqrt(np.mean(speed**2))
    tau = log.tau.copy()
    tau[stuck, JOINT] += 0.4 * np.gradient(tau[:, JOINT], log.t)[stuck]
    for given, least, most in (
        (replace(log, tau=tau), -np.inf, _IN_MOTION),
        (late(log, JOINT), 0.9, 1.1),
    ):
        model, sigma = rough_of(arm, given)
        whole = model.lateness(sigma).seconds[JOINT]
        moving = model.lateness_in_motion(sigma, JOINT).seconds[JOINT]
        assert abs(whole) > 1e-3 and least < moving / whole < most
