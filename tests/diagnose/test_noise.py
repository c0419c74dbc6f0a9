"""Noise row by row: what the doubt of the motion makes of a model."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, DECLARED, blank, log_with, small_arm

from jaxswarm.diagnose.decision import material as structure
from jaxswarm.diagnose.decision.material import find_material, is_material
from jaxswarm.diagnose.decision.remainder import remainders
from jaxswarm.diagnose.decision.rules import MATERIAL
from jaxswarm.diagnose.decision.unexplained import Unexplained
from jaxswarm.diagnose.folds.noise import (
    noise_of,
    row_doubt,
    row_noise,
    row_weight,
    with_motion_noise,
)
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import Noise, synthetic_log
from jaxswarm.logs.motion import prepare


def fitted(**more):
    log = log_with(**more)
    return with_motion_noise(estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False))


@pytest.fixture(scope="module")
def clean():
    return fitted()


def test_a_clean_log_is_left_with_its_noise_in_all_rows(clean):
    standard = clean.fit.residual / row_noise(clean)
    assert (np.abs(np.sqrt((standard**2).mean(axis=0)) - 0.95) < 0.2).all()
    assert all(r.near for r in remainders(clean))


def test_rows_in_which_a_joint_turns_round_are_known_less_and_count_less():
    # Positions ten times worse: the steep sign of friction makes torque of them.
    found = fitted(noise=Noise(2e-4, 0.02))
    smooth = tuple(t for t in found.model.terms if not t.law.uses_direction)
    without = with_motion_noise(replace(found, model=replace(found.model, terms=smooth)))
    rows, slow = row_noise(found) / row_noise(without), np.abs(found.motions[0].dq)
    slow = slow[found.motions[0].decimator.kept(len(slow))]
    weight = row_weight(found) / row_weight(found).max(axis=0)
    for j in range(2):
        turning = slow[:, j] < np.quantile(slow[:, j], 0.03)
        moving = slow[:, j] > np.median(slow[:, j])
        assert np.median(rows[turning, j]) > 1.05 * np.median(rows[moving, j])
    doubt = row_doubt(found)
    assert (np.corrcoef(doubt.ravel(), weight.ravel())[0, 1]) < -0.5


def test_an_impact_is_noise_where_it_is_and_nowhere_else():
    log = log_with()
    quiet = fitted()
    tau = np.array(log.tau)
    at = len(tau) // 2
    # Alternating: as much power above the compared band as in it.
    tau[at : at + 12, 0] += 8.0 * (-1.0) ** np.arange(12)
    found = with_motion_noise(
        estimate(small_arm(), blank(), [prepare(replace(log, tau=tau), BAND)], bounded=False)
    )
    ratio = row_noise(found)[:, 0] / row_noise(quiet)[:, 0]
    t = found.regression.t
    near, far = np.abs(t - log.t[at]) < 0.1, np.abs(t - log.t[at]) > 1.0
    assert ratio[near].min() > 2.0
    assert np.abs(ratio[far] - 1.0).max() < 0.3


def test_what_rings_above_the_band_is_noise_in_it_by_what_it_leaves_there():
    """A drive that rings at one frequency has as much per hertz there alone."""
    log, quiet = log_with(), fitted()
    cutoff = quiet.motions[0].torque_cutoff
    part = (log.t > 5.0) & (log.t < 10.0)
    tau = np.array(log.tau)
    tau[part, 0] += 1.0 * np.sin(2 * np.pi * 2.2 * cutoff * log.t[part])
    ringing = prepare(replace(log, tau=tau), BAND)
    found = with_motion_noise(estimate(small_arm(), blank(), [ringing], bounded=False))
    rows = (found.regression.t > 6.0) & (found.regression.t < 9.0)
    left = np.sqrt((found.fit.residual[rows, 0] ** 2).mean())
    noise = np.sqrt((row_noise(found)[rows, 0] ** 2).mean())
    assert 0.5 < left / noise < 1.5


@pytest.mark.parametrize("rate", [100.0, 125.0])
def test_what_position_noise_makes_above_the_band_is_not_counted_in_it_twice(rate):
    """It grows with the frequency and is drawn by itself: the noise was told as twice what is left."""
    ratio = []
    for seed in range(4):
        log = synthetic_log(
            small_arm(), DECLARED, seed, noise=Noise(2e-4, 1e-3), duration=24.0, rate=rate
        )
        found = estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False)
        ratio.append(found.fit.sigma / noise_of(with_motion_noise(found)))
    assert (np.mean(ratio, axis=0) > 0.62).all()
    assert (np.mean(ratio, axis=0) < 1.2).all()


def test_the_noise_of_a_log_is_that_of_its_rows(clean):
    np.testing.assert_allclose(noise_of(clean), np.sqrt((row_noise(clean) ** 2).mean(axis=0)))


def test_structure_within_the_noise_is_told_as_part_of_it():
    def item(joint, share):
        return Unexplained(
            joint, ("q_joint1",), share, 1e-9, np.zeros(3), np.zeros((3, 1)), None, None
        )

    kept = [u for u in (item(0, 0.4), item(1, 0.4)) if is_material(u, (1.3, 4.0))]
    assert [u.joint for u in kept] == [1]
    assert np.sqrt(0.4) * 1.3 < MATERIAL < np.sqrt(0.4) * 4.0


@pytest.mark.parametrize("quiet", [0, 1])
def test_joints_within_their_noise_are_not_looked_at(monkeypatch, clean, quiet):
    """The same as looking at all of them: the share of a joint is one at most."""
    left = np.where(np.arange(3) == quiet, 0.9, 1.4)
    looked = []
    monkeypatch.setattr(structure, "over_noise", lambda found: left)
    monkeypatch.setattr(structure, "find_unexplained", lambda *a: looked.extend(a[-1]) or [])
    assert find_material(clean, None) == []
    assert looked == [j for j in range(3) if j != quiet]


def test_rows_beside_a_jump_between_two_samples_are_known_to_a_part_of_it(clean):
    """A clean log of 50 Hz with moves of constant acceleration was left with four times its noise."""
    motion = replace(clean.motions[0], steady_noise=np.zeros(2))
    jump, sharp = np.zeros((2, *motion.sharp_noise.shape))
    jump[50:53, 0], sharp[52:60, 0] = 0.4, 0.3

    def noise(**more):
        return row_noise(replace(clean, motions=(replace(motion, **more),)))

    quiet = noise(jump_noise=0.0 * jump, sharp_noise=0.0 * sharp)
    known = noise(jump_noise=jump, sharp_noise=sharp)
    told = np.maximum(jump, sharp)  # a jump is sharp, and counts once
    np.testing.assert_allclose(known, np.hypot(quiet, told), rtol=1e-9)


def test_what_is_steady_is_noise_up_to_a_small_part_of_the_torque(clean):
    """A joint that rubs at narrow places for moments was left with 29 times its sensor's, and told near it."""
    none, size = (
        0.0 * clean.motions[0].sharp_noise,
        np.sqrt((clean.regression.torque**2).mean(axis=0)),
    )
    still = {"sharp_noise": none, "jump_noise": none, "model_noise": none}

    def noise(steady):
        motion = replace(clean.motions[0], steady_noise=steady, **still)
        return row_noise(replace(clean, motions=(motion,)))[0]

    sensor = noise(0.0 * size)
    np.testing.assert_allclose(noise(2.0 * sensor), 2.0 * sensor, rtol=1e-9)
    most = np.hypot(sensor, np.maximum(0.01 * size, 10.0 * sensor))
    np.testing.assert_allclose(noise(0.2 * size), most, rtol=1e-9)
