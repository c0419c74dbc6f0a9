"""What pushes a joint looks late at one frequency, what sticks at rest alone, a late torque always."""

from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.effects.term import Term
from jaxswarm.identify.checks.check_log import against_robot
from jaxswarm.identify.checks.late import (
    _IN_MOTION,
    _WITHOUT_FRICTION,
    _apart,
)
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.rough_columns import strongest_line
from jaxswarm.identify.checks.samples import fine_samples, samples_of
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


def winding_up(joints, share=0.02):
    """A clean log whose torques of some joints run 0.4 s ahead where they hardly move."""

    def of(arm):
        log = synthetic_log(arm, (), 3, noise=Noise(2e-5, 0.05), rate=RATE, duration=20.0)
        speed = np.gradient(log.q, log.t, axis=0)
        stuck = np.abs(speed) < share * np.sqrt(np.mean(speed**2, axis=0))
        stuck &= np.isin(np.arange(arm.num_joints), joints)
        return log, np.where(stuck, log.tau + 0.4 * np.gradient(log.tau, log.t, axis=0), log.tau)

    return of


def test_a_torque_that_runs_ahead_where_its_joint_sticks_alone_is_early_at_rest_alone(arm):
    log, tau = winding_up([JOINT])(arm)
    for given, least, most in (
        (replace(log, tau=tau), -np.inf, _IN_MOTION),
        (late(log, JOINT), 0.9, 1.1),
    ):
        model, sigma = rough_of(arm, given)
        whole = model.lateness(sigma).seconds[JOINT]
        moving = model.lateness_in_motion(sigma).seconds[JOINT]
        assert abs(whole) > 1e-3 and least < moving / whole < most


def test_a_joint_that_moves_is_not_late_against_others_that_stick(arm):
    others = [j for j in range(arm.num_joints) if j != JOINT]
    log, tau = winding_up(others, 0.15)(arm)
    model, sigma = rough_of(arm, replace(log, tau=tau))
    whole, moving = (
        _apart(model.lateness(sigma))[JOINT],
        _apart(model.lateness_in_motion(sigma))[JOINT],
    )
    assert whole > 5e-3 and abs(moving) < 0.2 * whole


def test_a_fine_model_knows_of_drag(arm):
    """What an undeclared one left on its joint made the torque of the other joint of an arm look late."""
    left = []
    for hidden in ((), (Term("quadratic_drag", 5, values={"c": 5.0}),)):
        log = synthetic_log(arm, hidden, 3, noise=Noise(2e-5, 0.05), rate=RATE, duration=20.0)
        fine = Rough(arm, fine_samples(prepare_segments(log, Filtering())[1]))
        left.append(fine.as_logged()[0].left[5] * fine.spread[5])
    assert left[1] < 1.3 * left[0]


@pytest.mark.parametrize("friction_too", [True, False])
def test_a_torque_is_late_in_its_friction_too(arm, friction_too):
    """Friction that grows with the load leaves what follows the rest of a torque alone."""
    quiet = {"noise": Noise(2e-5, 0.05), "rate": RATE}
    terms = tuple(
        Term(effect, JOINT, values={name: value})
        for effect, name, value in (("coulomb_friction", "fc", 8.0), ("viscous_friction", "b", 8.0))
    )
    free, log = (synthetic_log(arm, some, 3, **quiet) for some in ((), terms))
    shift = -0.02 * np.gradient((log if friction_too else free).tau[:, JOINT], log.t)
    tau = log.tau + shift[:, None] * (np.arange(arm.num_joints) == JOINT)
    given = replace(log, tau=tau)
    model, sigma = rough_of(arm, given)
    with_it, without = model.lateness(sigma), model.lateness_without_friction(sigma, JOINT)
    part = without.gain[JOINT] / with_it.gain[JOINT]
    assert part < 1.0 if friction_too else part > _WITHOUT_FRICTION
    assert told(arm, given) == (["late_torque"] if friction_too else [])
