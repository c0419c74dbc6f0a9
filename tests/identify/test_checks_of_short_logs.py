"""Logs with few rows per parameter: wrong scales and late torques that show by far are told, a bend is none."""

from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.effects.term import Term
from jaxswarm.identify.checks.channels import _is_valley
from jaxswarm.identify.checks.check_log import against_robot
from jaxswarm.identify.checks.guesses import Guess
from jaxswarm.identify.checks.late import late_torque
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.rough_fit import ROWS_THAT_HOLD
from jaxswarm.identify.checks.samples import fine_samples, samples_of
from jaxswarm.identify.checks.sound import Tried
from jaxswarm.identify.checks.torque_unit import wrong_unit
from jaxswarm.identify.synthetic import Noise, random_links, synthetic_log
from jaxswarm.logs import Log
from jaxswarm.logs.frozen import without_stuck
from jaxswarm.logs.motion import Filtering
from jaxswarm.logs.segments import prepare_segments
from jaxswarm.robot.load import load_robot


@pytest.fixture(scope="module")
def short(arm):
    return synthetic_log(arm, (), 3, noise=Noise(2e-5, 0.05), duration=7.0, rate=125.0)


def column(values, joint, change):
    changed = values.copy()
    changed[:, joint] = change(values[:, joint])
    return changed


def told(arm, log):
    _, motions = prepare_segments(log, Filtering(torque_cutoff=5.0))
    rough = Rough(arm, samples_of(motions))
    assert rough.rows_per_parameter < ROWS_THAT_HOLD
    return [one.check for one in against_robot(arm.replace(parameters=np.zeros((6, 10))), motions)]


def test_a_short_log_that_is_right_is_not_doubted(arm, short):
    assert told(arm, short) == []


@pytest.mark.parametrize(
    ("check", "spoil"),
    [
        ("torque_scale", lambda log: replace(log, tau=column(log.tau, 1, lambda x: 0.5 * x))),
        ("time_scale", lambda log: replace(log, t=2.0 * log.t)),
        ("encoder_scale", lambda log: replace(log, q=column(log.q, 2, lambda x: 2.0 * x))),
        (
            "late_torque",
            lambda log: replace(
                log, tau=column(log.tau, 1, lambda x: np.interp(log.t - 0.02, log.t, x))
            ),
        ),
    ],
)
def test_what_is_wrong_by_far_is_told_of_a_short_log(arm, short, check, spoil):
    assert told(arm, spoil(short)) == [check]


@pytest.mark.parametrize("joint", [3, 5])
def test_halves_of_a_short_log_are_asked_with_one_arm(arm, short, joint):
    """A half of its own bends its own arm until nothing is late: joint 3 was not told."""
    late = column(short.tau, joint, lambda x: np.interp(short.t - 0.02, short.t, x))
    _, motions = prepare_segments(replace(short, tau=late), Filtering(torque_cutoff=5.0))
    found = late_torque(
        arm,
        *(Rough(arm, made(motions)) for made in (samples_of, fine_samples)),
        motions[0].interval,
    )
    assert found is not None and f"the torque of {arm.joints[joint]} is " in found.what


def test_a_late_torque_is_told_beside_a_unit_that_may_be_another(arm, short):
    late = column(short.tau, 1, lambda x: np.interp(short.t - 0.02, short.t, x))
    assert told(arm, replace(short, tau=1e-2 * late)) == ["torque_unit", "late_torque"]


def test_a_torque_scale_is_a_valley():
    """Where every smaller torque of a joint helps the others alike, it is not its scale that is wrong."""
    joint = (2,)
    guesses = [Guess("torque_scale", "", joint, f * np.eye(3)) for f in (0.01, 0.1, 0.5, 2.0)]

    def is_valley(lefts):
        tried = [
            (g, Tried(np.array([x]), np.array([0.1]))) for g, x in zip(guesses, lefts, strict=True)
        ]
        return [_is_valley(g, t, tried, 1.0) for g, t in tried]

    assert is_valley([0.30, 0.20, 0.31, 0.90]) == [False, True, False, False]
    assert is_valley([0.22, 0.20, 0.24, 0.90]) == [False] * 4


def test_rotors_behind_gears_are_no_misfit(arm):
    """Of links alone their torque would leave a share that hides what is asked for."""
    rotors = tuple(Term("rotor_inertia", j, values={"ia": 5.0}) for j in range(6))
    log = synthetic_log(arm, rotors, 3, noise=Noise(0.0, 0.05), duration=20.0, rate=125.0)
    rough = Rough(arm, samples_of(prepare_segments(log, Filtering(torque_cutoff=5.0))[1]))
    assert rough.as_logged()[0].left.max() < 0.02


@pytest.mark.parametrize("mass", [2.5, 8.0])
def test_millinewton_meters_on_a_light_arm_are_told(mass):
    bare = load_robot("ur10e")
    links = random_links(bare, np.random.default_rng(0), mass=mass)
    log = synthetic_log(
        bare.replace(parameters=links), (), 3, noise=Noise(0.0, 0.0), duration=8.0, rate=125.0
    )
    samples = samples_of(prepare_segments(log, Filtering(torque_cutoff=5.0))[1])
    unknown = bare.replace(parameters=np.zeros((6, 10)))
    assert wrong_unit(unknown, samples) is None
    found = wrong_unit(unknown, replace(samples, tau=1e3 * samples.tau))
    assert found is not None and found.check == "torque_unit"
    assert found.refused == (mass > 3.0)


def log_of_two(rng, change):
    t = np.arange(1500) * 0.01
    q = np.sin(np.outer(t, [1.0, 1.7]))
    tau = 5.0 * q + 0.1 * rng.normal(size=q.shape)
    return Log("made", ("a", "b"), t, q, tau=change(tau))


def stands(tau, start, end):
    rows = np.arange(len(tau))
    return column(tau, 1, lambda x: np.where((rows < start) | (rows >= end), x, x[start]))


@pytest.mark.parametrize(
    ("change", "count", "refused"),
    [
        (lambda tau: tau, 0, False),
        (lambda tau: stands(tau, 300, 500), 1, False),
        (lambda tau: stands(tau, 700, 1500), 1, True),
        # One sample in three differs by the step of a channel that is as noisy.
        (lambda tau: stands(0.15 * np.round(tau / 0.15), 300, 500), 1, False),
        # Coarse torques stand for as long as nothing moves, and those of all joints where the robot is off.
        (lambda tau: stands(np.round(tau), 300, 500), 0, False),
        (lambda tau: np.where((np.arange(1500) // 200 == 2)[:, None], tau[400], tau), 0, False),
    ],
)
def test_a_noisy_torque_that_stands_while_others_go_on_is_stuck(change, count, refused):
    log = log_of_two(np.random.default_rng(0), change)
    after, found = without_stuck(log)
    assert [(one.check, one.refused) for one in found] == [("stuck", refused)] * count
    assert all("torque of b stands" in one.what for one in found)
    assert (len(after.t) < len(log.t)) == (count > 0 and not refused)


def test_less_than_a_sample_apart_is_how_drives_are_read(arm, short):
    late = column(short.tau, 1, lambda x: np.interp(short.t - 0.02, short.t, x))
    _, motions = prepare_segments(replace(short, tau=late), Filtering(torque_cutoff=5.0))
    rough = Rough(arm, samples_of(motions))
    fine = Rough(arm, fine_samples(motions))
    assert late_torque(arm, rough, fine, 0.016).check == "late_torque"
    assert late_torque(arm, rough, fine, 0.025) is None
