"""Friction that chance alone makes says nothing about the sign of a torque."""

from dataclasses import replace

import jax
import numpy as np
import pytest

from jaxswarm.identify.checks.channels import _believed, wrong_channels
from jaxswarm.identify.checks.check_log import against_robot
from jaxswarm.identify.checks.faint import brakes
from jaxswarm.identify.checks.guess import Guess
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.samples import Samples, samples_of
from jaxswarm.identify.checks.sound import NONE, Tried, is_sound
from jaxswarm.identify.synthetic import Noise, random_links, synthetic_log
from jaxswarm.logs.motion import Filtering
from jaxswarm.logs.segments import prepare_segments
from jaxswarm.robot import inverse_dynamics, rx60


def samples(noise: float, friction: float, seed: int, rows: int = 300) -> Samples:
    """20 s of an arm whose joint 1 feels ``noise`` times its torque and ``friction`` times it."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0.0, 20.0, rows)
    w = 2 * np.pi * np.array([0.11, 0.17, 0.23])
    turns, phase = np.array([0.9, 0.5, 0.7]), rng.uniform(0, 2 * np.pi, 3)
    q, dq, ddq = (
        turns * np.sin(w * t[:, None] + phase),
        turns * w * np.cos(w * t[:, None] + phase),
        -turns * w**2 * np.sin(w * t[:, None] + phase),
    )
    arm = rx60()
    tau = np.array(jax.vmap(inverse_dynamics, (None, 0, 0, 0))(arm, q, dq, ddq))
    size = tau[:, 0].std()
    tau[:, 0] += size * (noise * rng.normal(size=len(t)) + friction * np.sign(dq[:, 0]))
    noisy = tau + 1e-3 * rng.normal(size=tau.shape)
    return Samples(t, q, dq, ddq, noisy, np.gradient(tau, t, axis=0))


def told(one: Samples):
    rough = Rough(rx60(), one)
    return wrong_channels(rx60(), rough, lambda: rough)


@pytest.mark.parametrize("seed", range(20))
def test_a_joint_of_noise_has_no_sign(seed):
    assert told(samples(5.0, 0.0, seed, rows=60)) is None


@pytest.mark.parametrize("seed", range(3))
def test_a_joint_that_friction_drives_has_the_wrong_sign(seed):
    one = samples(0.3, 0.5, seed)
    assert told(one) is None
    wrong = np.array([-1.0, 1.0, 1.0])
    found = told(replace(one, tau=wrong * one.tau, tau_rate=wrong * one.tau_rate))
    assert found.check == "torque_sign" and "joint1" in found.what


def test_a_scale_that_leaves_much_of_its_own_torque_is_not_believed():
    """On a clean log of an arm of seven joints a badly explained one let the others bend."""
    half = Guess("torque_scale", "half", (2,), np.diag([1.0, 1.0, 0.5]))
    brake = np.ones(3)
    logged = Tried(np.array([0.06, 0.11, 0.22]), brake)
    poorly, well = (Tried(np.array([0.06, 0.05, left]), brake) for left in (0.17, 0.1))
    assert not is_sound(half, poorly) and is_sound(half, well)
    assert _believed(half, well, logged, 1.0)


def test_a_position_of_the_wrong_sign_that_leaves_little_is_asked_for():
    """At a vertical base the torque's sign explains it as well: of both nobody knows which it is."""
    bare = rx60()
    arm = bare.replace(parameters=random_links(bare, np.random.default_rng(1), mass=10.0))
    log = synthetic_log(arm, (), 3, noise=Noise(2e-5, 0.05), duration=20.0, rate=125.0)
    wrong = replace(log, q=log.q * np.array([-1.0, 1.0, 1.0]))
    _, motions = prepare_segments(wrong, Filtering(torque_cutoff=5.0))
    logged, _ = Rough(arm, samples_of(motions)).as_logged()
    assert logged.size < 0.1 and logged.left.max() < 0.2
    (found,) = against_robot(arm, motions)
    assert "the torque or the position of joint1 has the wrong sign" in found.what


def test_a_sign_is_right_whose_friction_brakes_in_a_fine_model(monkeypatch):
    """Of a drive that jitters a rough model has friction that drives, a fine one friction that brakes."""
    one = samples(0.3, 0.5, 0)
    wrong = replace(one, tau=one.tau * [-1.0, 1.0, 1.0], tau_rate=one.tau_rate * [-1.0, 1.0, 1.0])
    rough, right = Rough(rx60(), wrong), Rough(rx60(), one)
    assert right.as_logged()[0].braking[0] > NONE > rough.as_logged()[0].braking[0]
    assert wrong_channels(rx60(), rough, lambda: rough).check == "torque_sign"
    assert wrong_channels(rx60(), rough, lambda: right) is None
    # Of too few rows a fine model says nothing.
    monkeypatch.setattr(Rough, "strictness", 4.0)
    assert not brakes(right, Guess("torque_sign", "", (0,)))
