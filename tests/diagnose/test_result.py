"""What ``diagnosis.json`` and the report hold."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, blank, diagnose_log, log_with, small_arm

from jaxswarm.diagnose import Rules, diagnose
from jaxswarm.diagnose.decision.remainder import Remainder
from jaxswarm.diagnose.decision.rules import NEAR
from jaxswarm.diagnose.decision.unexplained import Unexplained
from jaxswarm.diagnose.decision.verdict import verdict
from jaxswarm.diagnose.report import figures as pictures
from jaxswarm.diagnose.report.error_change import grown
from jaxswarm.diagnose.report.html import render
from jaxswarm.diagnose.report.orders import order_pictures
from jaxswarm.diagnose.report.result import to_result
from jaxswarm.diagnose.report.text import next_steps, verdict_sentence
from jaxswarm.diagnose.run import conclude, write_report
from jaxswarm.diagnose.selection.outcome import outcome_of
from jaxswarm.drawing import Drawing
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.model import load_model, model_torque
from jaxswarm.logs.motion import prepare
from jaxswarm.outputs import to_json

SPRING = Term("joint_spring", 0, values={"k": 6.0, "tau0": 1.0})
LEFT = Unexplained(1, ("q_joint2",), 0.4, 1e-5, np.zeros(3), np.zeros((3, 1)), None, np.zeros(1))


@pytest.fixture(scope="module")
def found():
    return diagnose_log(log_with(SPRING))


@pytest.fixture(scope="module")
def clean():
    return diagnose_log(log_with())


@pytest.fixture(scope="module")
def unseen():
    return [prepare(log_with(SPRING, seed=2), BAND)]


@pytest.fixture(scope="module")
def result(found, unseen):
    return conclude(found, unseen)[0]


def test_keys_of_the_contract(result):
    assert {
        "robot", "joints", "declared", "effects", "steps", "unexplained", "undecided", "error",
        "verdict",
    } <= set(result)  # fmt: skip
    assert result["joints"] == ["joint1", "joint2"]
    assert {"effect": "coulomb_friction", "joint": "joint2"} in result["declared"]
    effect = result["effects"][0]
    assert (effect["effect"], effect["joint"]) == ("joint_spring", "joint1")
    assert {"parameters", "gain", "alternatives"} <= set(effect)
    assert set(effect["parameters"]["k"]) >= {"value", "std_error", "unit"}
    assert effect["parameters"]["k"]["unit"] == "N m/rad"
    assert set(result["steps"][0]) >= {"added", "before", "after"}
    assert set(result["error"]) >= {"before", "after", "noise_floor"}


def test_values_and_intervals(result):
    k = result["effects"][0]["parameters"]["k"]
    low, high = k["interval_95"]
    assert low < k["value"] < high
    assert (high - low) / 2 == pytest.approx(1.96 * k["std_error"])
    assert abs(k["value"] - 6.0) < 4 * k["std_error"] < 2.0


def test_errors_are_on_the_validation_log_and_fall(result):
    before, after = result["error"]["before"], result["error"]["after"]
    assert after["rms"][0] < 0.5 * before["rms"][0]
    assert result["steps"][0]["before"] == before
    # After the steps all is fitted once more, with the widths of signs as they were declared.
    assert result["steps"][-1]["after"]["rms"] == pytest.approx(after["rms"], rel=0.01)
    assert after["on"].startswith("synthetic")
    floor = result["error"]["noise_floor"]["rms"]
    assert 0.7 < after["rms"][0] / floor[0] < 1.5


def test_without_validation_errors_are_on_held_out_time(found):
    assert to_result(outcome_of(found))["error"]["after"]["on"] == "held-out blocks of time"


def test_verdicts():
    near, far = (Remainder(0, times, (), (0.0, 1.0)) for times in (1.2, 3.3))
    assert verdict(0, [], [near]) == "nothing missing"
    assert verdict(0, [LEFT], [near]) == "unexplained"
    assert verdict(0, [], [near, far]) == "unexplained"
    assert verdict(1, [], [near]) == "explained"
    assert verdict(1, [LEFT], [near]) == "partly explained"
    assert verdict(1, [], [far]) == "partly explained"


def test_no_verdict_contradicts_the_noise(found, clean):
    for one in (found, clean):
        told = to_result(outcome_of(one))
        assert max(told["residual_over_noise"]) < NEAR and told["proof"] == "held-out regions"
    # Half of the torque's error is made unexplained: a model without the spring.
    blind = replace(found, steps=(), final=found.declared)
    told = to_result(outcome_of(blind))
    assert told["verdict"] == "unexplained" and told["residual_over_noise"][0] > NEAR
    entry = told["unexplained"][0]
    assert entry["joint"] == "joint1" and entry["depends_on"] == [] and entry["windows"]
    assert entry["share"] == pytest.approx(1 - 1 / told["residual_over_noise"][0] ** 2)
    assert "times the noise" in verdict_sentence(told)


def test_a_log_whose_torque_is_noise_cannot_be_judged(clean):
    rng = np.random.default_rng(0)
    fit = clean.final.fit
    noise = replace(fit, residual=clean.final.regression.torque)
    deaf = replace(clean.final, fit=noise, regression=replace(
        clean.final.regression, torque=rng.normal(size=fit.residual.shape)))  # fmt: skip
    told = to_result(outcome_of(replace(clean, final=deaf, declared=deaf)))
    assert told["verdict"] == "cannot be judged"
    assert "units" in verdict_sentence(told)


def test_joints_that_move_one_by_one_are_judged_by_their_noise(clean, unseen):
    """No part of such a log tells what the others do: sixteen times the torque was left of a clean one."""
    outcome = outcome_of(clean)
    scattered = replace(outcome, after={**outcome.after, "relative_global": 16.4})
    told = to_result(scattered)
    assert told["verdict"] == "nothing missing" and told["proof"] == "none"
    assert any("1640 % of the torque" in reason for reason in told["reasons"])
    assert not any("held-out time" in reason for reason in to_result(outcome)["reasons"])
    # Of another log it is what it says.
    seen = outcome_of(clean, [], unseen)
    assert to_result(replace(seen, after=scattered.after))["verdict"] == "cannot be judged"


def test_of_several_validation_logs_the_worst_leads(found, unseen):
    other = prepare(log_with(seed=3), BAND)  # without the spring: there the addition does harm
    told = to_result(outcome_of(found, [], [*unseen, replace(other, source="without")]))
    assert [v["on"] for v in told["error"]["validation"]] == [unseen[0].source, "without"]
    assert told["error"]["after"]["on"] == "without" and told["proof"] == "other motion"


def test_an_error_that_grew_on_another_log_is_told():
    entry = {"on": "b", "before": {"rms": [1.0, 0.1]}, "after": {"rms": [1.5, 0.15]}}
    noise = np.array([0.2, 0.2])  # what happens below it is no harm
    assert grown([entry], ("j1", "j2"), noise, 1.05) == ["on b the error of j1 grew from 1 to 1.5"]


def test_sentence_of_every_verdict(found, clean):
    for one in (found, clean):
        for left in ([], [LEFT]):
            told = to_result(outcome_of(one, left))
            sentence = verdict_sentence(told)
            assert ("joint_spring on joint1" in sentence) == bool(one.steps)
            assert ("q_joint2" in sentence) == bool(left)
            assert bool(next_steps(told)) or not left


def test_result_is_json_and_every_rejection_has_a_reason(result):
    again = json.loads(to_json(result))
    assert again["verdict"] == "explained"
    assert again["not_added"] and all(s["rejected_because"] for s in again["not_added"])


def test_report_is_self_contained_with_an_image_per_effect(found, result, unseen, tmp_path):
    result = {**result, "logs": []}
    with Drawing() as drawing:
        order_pictures(drawing, found, unseen)
        write_report(found, [], result, drawing, tmp_path)
    page = (tmp_path / "report.html").read_text()
    bare = re.sub(r'="data:[^"]*"|<a href="https://search[^"]*"', "", page)
    assert not re.search(r"(src|href)\s*=", bare)
    assert "http" not in bare and "url(" not in bare and "@import" not in bare
    assert page.count('alt="joint_spring on joint1: ') == len(result["effects"]) == 1
    assert verdict_sentence(result).split(" (")[0] in page
    assert (tmp_path / "effect_1.png").read_bytes().startswith(b"\x89PNG")
    written = json.loads((tmp_path / "diagnosis.json").read_text())
    assert written["effects"][0]["effect"] == "joint_spring"
    model = load_model(tmp_path / "model.json")
    np.testing.assert_allclose(
        model_torque(model, unseen[0]), model_torque(found.final.model, unseen[0]), atol=1e-9
    )


def test_the_picture_of_a_change_shows_the_change(found):
    """Against an earlier model the effect is drawn against what that model already had of it."""
    step, final = found.kept[0], found.final.model
    whole = pictures.evidence(step, final, found.final.motions[0])
    nothing = pictures.evidence(replace(step, rest=final), final, found.final.motions[0])
    sizes = [np.abs(f.axes[0].get_lines()[1].get_ydata()).max() for f in (whole, nothing)]
    assert sizes[0] > 1.0 and sizes[1] < 1e-12


def test_report_escapes_what_it_is_told(result):
    images = {n: b"x" for n in ("ladder.png", "effect_1.png", "torque.png", "residual.png")}
    page = render({**result, "robot": "<b>", "logs": []}, {**images, "residual_before.png": b"x"})
    assert "<b>" not in page and "&lt;b&gt;" in page


def test_clock_that_is_read_late_is_told_and_is_no_effect():
    found = diagnose_log(log_with(Term("time_delay", values={"seconds": 0.002})))
    assert not found.kept
    told = to_result(outcome_of(found))
    assert told["filtering"]["clock_skew_s"] == pytest.approx(0.002, abs=3e-4)
    images = dict.fromkeys(("ladder.png", "torque.png", "residual_before.png", "residual.png"), b"")
    late = 1e3 * told["filtering"]["clock_skew_s"]
    assert f"read {late:.2f} ms after the position" in render(told, images)


def test_pictures_have_a_figure_for_every_step(found):
    for step in found.steps:
        figure = pictures.evidence(step, found.final.model, found.final.motions[0])
        assert figure.axes


def test_the_rules_that_decided_are_told():
    strict = Rules(share=0.5)
    found = diagnose(small_arm(), blank(), [prepare(log_with(), BAND)], rules=strict)
    told = to_result(outcome_of(found))
    assert told["rules"]["share"] == 0.5 and found.rules == strict


def test_a_law_that_one_joint_lacks_does_not_part_torque_and_motion(clean):
    """Of a slow log whose fit left a few percent of every torque it was said to have wrong units."""
    outcome = outcome_of(clean)
    after = {**outcome.after, "relative_global": 95673.0}
    left = clean.final.fit.residual.copy()
    left[:, 1] *= 6.0
    lacking = replace(clean.final, fit=replace(clean.final.fit, residual=left))
    told = to_result(replace(outcome_of(replace(clean, final=lacking)), after=after))
    assert told["verdict"] == "unexplained" and told["proof"] == "none"
    assert told["residual_over_noise"][1] > NEAR
