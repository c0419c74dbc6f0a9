"""Errors on other motion: where joints move and where they stand, and how large they are expected to be."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, blank, log_with, small_arm
from results import explained

from jaxswarm.diagnose.decision.verdict import EXPLAINED, NOTHING, PARTLY, UNEXPLAINED, verdict
from jaxswarm.diagnose.folds.noise import noise_of, with_motion_noise
from jaxswarm.diagnose.report.remains import left_open
from jaxswarm.diagnose.report.text import evidence_sentence, next_steps
from jaxswarm.diagnose.selection import elsewhere
from jaxswarm.diagnose.selection.elsewhere import compared, expected, log_residual, rms
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.diagnose.selection.survives import survives
from jaxswarm.diagnose.selection.unseen_errors import UnseenErrors
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.forward.model import linear_values, with_linear_values
from jaxswarm.identify.forward.names import column_names
from jaxswarm.logs.motion import prepare

SPRING = Term("cubic_spring", 1, values={"q0": 0.2, "k3": 25.0})


@pytest.fixture(scope="module")
def other():
    return prepare(log_with(SPRING, seed=5, motion_seed=11), BAND)


def fits(**log):
    """Fits of a log with a spring, without and with it."""
    motion = prepare(log_with(SPRING, **log), BAND)
    before = with_motion_noise(estimate(small_arm(), blank(), [motion], bounded=False))
    return before, refit(before, (*before.model.terms, SPRING))


def residuals(moving_error: float, standing_error: float, rows: int = 200):
    """Residual (T, 1) of a joint that moves in the first half, and when it does."""
    moving = (np.arange(rows) < rows // 2)[:, None]
    return np.where(moving, moving_error, standing_error), moving


def test_what_dry_friction_holds_at_rest_does_not_hide_what_motion_shows():
    before, moving = residuals(0.25, 2.8)
    after, _ = residuals(0.15, 2.8)
    one, two, falls, _ = compared(before, after, moving)
    assert two[0] / one[0] > 0.99
    assert falls[0]


def test_what_helps_at_rest_alone_is_a_fall_too():
    before, moving = residuals(0.25, 2.8)
    after, _ = residuals(0.25, 1.0)
    assert compared(before, after, moving)[2][0]


def test_neither_a_standing_joint_nor_an_equal_error_falls():
    before, moving = residuals(0.25, 0.0)
    assert not compared(before, before, moving)[2][0]
    assert not compared(before * 0.0, before * 0.0, moving)[2][0]
    assert not compared(before, before, np.zeros_like(moving))[2][0]


def test_a_rise_in_one_stretch_is_chance_and_one_all_along_is_not():
    """Both raise the RMS error by the same two fifths."""
    rng = np.random.default_rng(0)
    before = rng.normal(size=(400, 1))
    moving = np.ones_like(before, bool)
    everywhere = 1.4 * before
    burst = before.copy()
    burst[100:110] *= np.sqrt(1 + 0.96 * (before**2).sum() / (before[100:110] ** 2).sum())
    for after, sure in ((everywhere, True), (burst, False), (before, False)):
        one, two, _, rises = compared(before, after, moving)
        assert rises[0] == sure
        assert after is before or np.isclose(two[0] / one[0], 1.4)


def test_a_true_model_leaves_of_another_log_what_is_expected(other):
    """Of logs of three to six seconds, which say little of the parameters, and of twelve, which say much."""
    over = []
    for duration in (3.0, 4.0, 6.0, 12.0):
        for seed in (7, 8, 9):
            before, true = fits(duration=duration, motion_seed=seed)
            noise = noise_of(before)
            most = expected(other, noise, before, true)
            over.extend(rms(log_residual(true, other)) / most)
            if duration == 12.0:
                assert (most < 2.0 * noise).all()
    assert np.mean(np.array(over) < 1.2) >= 0.9
    assert np.median(over) > 0.25


def test_a_true_law_is_not_refused_for_what_chance_drew_on_another_joint(other, monkeypatch):
    before, true = fits(duration=3.0)
    covariance = true.model.uncertainty.on(column_names(small_arm(), true.model.terms))
    size, axes = np.linalg.eigh(covariance)
    drawn = linear_values(true.model) - 1.5 * np.sqrt(size[-1]) * axes[:, -1]
    off = replace(true, model=with_linear_values(true.model, drawn))
    # The fit without the law happens to be right where that with it is off.
    lucky = replace(before, model=replace(true.model, terms=true.model.terms[:-1]))
    one, two = (rms(log_residual(fit, other)) for fit in (lucky, off))
    assert two[0] > 2.5 * one[0] and two[1] < 0.2 * one[1]
    assert survives(lucky, off, 1, [other]) is None
    monkeypatch.setattr(elsewhere, "_doubt", lambda found, motion: np.zeros(2))
    assert "raises the error of joint1" in survives(lucky, off, 1, [other])


def test_a_reader_is_told_which_error_the_fitted_motion_leaves_open(other):
    def told(fit):
        errors = UnseenErrors([other], fit, fit).validation
        assert "expected" in errors[0]
        floor = {"rms": noise_of(fit).tolist()}
        result = {
            "joints": ("joint1", "joint2"),
            "error": {"validation": errors, "noise_floor": floor},
        }
        return left_open(result)

    before, true = fits(duration=3.0)
    (line,) = told(true)
    assert line.startswith("On synthetic small, seed 5 joint") and "times the noise" in line
    # What a law is missing for is no doubt of the parameters.
    assert not told(fits(duration=12.0)[0])


def test_what_the_fitted_motion_leaves_open_is_in_the_sentence_of_the_verdict():
    told = explained()
    names, noise = told["joints"], told["error"]["noise_floor"]["rms"]
    entry = told["error"]["validation"][1]
    assert "leaves open" not in evidence_sentence(told)
    entry["after"] = entry["after"] | {"rms": [11.7 * noise[0], noise[1], 4.0 * noise[2]]}
    entry["expected"] = [20.0 * noise[0], noise[1], 4.1 * noise[2]]
    clause = (
        f"On second.csv {names[0]} is off by 11.7 times the noise, {names[2]} by 4.0: no further"
    )
    assert clause in evidence_sentence(told)
    assert any(f"{names[0]} (11.7 times the noise)" in line for line in next_steps(told))
    # What it does not leave open is told as missing, with nothing beside it.
    assert "leaves open" not in evidence_sentence(told | {"verdict": UNEXPLAINED})


def test_what_is_off_further_than_that_is_in_the_sentence_before_it_is_far_beyond():
    """A joint that left a tenth of its torque elsewhere, at 4.3 times its noise, was said to lack nothing."""
    told = explained()
    names, noise = told["joints"], told["error"]["noise_floor"]["rms"]
    entry = told["error"]["validation"][1]
    entry["expected"] = [1.6 * noise[0], noise[1], noise[2]]
    moving, rms = [4.3 * noise[0], 1.9 * noise[1], None], [4.0 * noise[0], noise[1], noise[2]]
    entry["after"] = entry["after"] | {"rms_moving": moving, "rms": rms}
    clause = f"On second.csv {names[0]} is off by 4.3 times the noise in motion, further than"
    assert clause in evidence_sentence(told)
    entry["expected"][0] = 4.1 * noise[0]  # one joint is in one sentence
    assert "in motion, further than" not in evidence_sentence(told)
    assert "no further than" in evidence_sentence(told)


def test_what_acts_on_another_log_alone_is_left_beyond_what_the_fitted_motion_leaves_open(other):
    """A log that was fitted shows no spring, or has it in its model: the other one has a spring."""
    plain = prepare(log_with(), BAND)
    without = with_motion_noise(estimate(small_arm(), blank(), [plain], bounded=False))
    (entry,) = UnseenErrors([other], without, without).validation
    assert [one["joint"] for one in entry["beyond"]] == ["joint2"]
    assert entry["beyond"][0]["over_noise"] > 5.0
    for duration in (3.0, 12.0):
        _, true = fits(duration=duration)
        (entry,) = UnseenErrors([other], true, true).validation
        assert not entry.get("beyond")


def test_what_another_log_alone_shows_is_in_the_verdict_and_its_sentence():
    assert [verdict(added, [], []) for added in (0, 1)] == [NOTHING, EXPLAINED]
    assert [verdict(added, [], [], beyond=True) for added in (0, 1)] == [UNEXPLAINED, PARTLY]
    told = explained() | {"verdict": PARTLY}
    names = told["joints"]
    left = [{"joint": names[0], "over_noise": 10.4}, {"joint": names[2], "over_noise": 5.86}]
    told["error"]["validation"][1]["beyond"] = left
    clause = f"n second.csv 10.4 times the noise is left on {names[0]}, 5.9 times on {names[2]}"
    assert f"more is missing that this log does not show: o{clause}." in evidence_sentence(told)
    assert any(line.startswith(f"O{clause}, in motion") for line in next_steps(told))
