"""The diagnosis on a terminal of 80 columns: nothing is cut, everything is told."""

import json
import re

import pytest
from results import JOINTS, RESULTS, changed, effect, explained, row, unexplained

from jaxswarm import console
from jaxswarm.diagnose.report.console import print_diagnosis
from jaxswarm.diagnose.report.flags import parameter_remark
from jaxswarm.diagnose.report.grids import by_joint
from jaxswarm.diagnose.report.numbers import value_text
from jaxswarm.diagnose.report.remains import near_noise
from jaxswarm.diagnose.report.text import evidence_sentence, next_steps, proof_sentence
from jaxswarm.diagnose.selection.survives import UNSHOWN
from jaxswarm.effects import REGISTRY


def printed(told, monkeypatch, capsys, **environment):
    for name, value in {"COLUMNS": "80", **environment}.items():
        monkeypatch.setenv(name, value)
    print_diagnosis(console.safe(told), None)
    return capsys.readouterr().out


@pytest.mark.parametrize("kind", RESULTS)
def test_nothing_is_cut_at_eighty_columns(kind, monkeypatch, capsys):
    told = RESULTS[kind]()
    out = printed(told, monkeypatch, capsys)
    assert "…" not in out and max(map(len, out.splitlines())) <= 80
    flat = " ".join(out.split())
    assert flat.startswith(f"{told['robot']}: {told['verdict']} {evidence_sentence(told)}")
    assert proof_sentence(told) in flat
    for line in [*next_steps(told), *(r for r in told["reasons"] if r not in flat)]:
        assert line in flat


def test_every_number_of_seven_joints_stands_whole(monkeypatch, capsys):
    told = explained()
    out = printed(told, monkeypatch, capsys)
    for cells in by_joint(told).rows:
        numbers = [cell for cell in cells if re.match(r"-?\d", cell)]
        assert re.search(r"\s+".join(map(re.escape, numbers)), out)


def test_effects_flags_refusals_and_findings_are_told(monkeypatch, capsys):
    flat = " ".join(printed(explained(), monkeypatch, capsys).split())
    effect = explained()["effects"][0]
    assert effect["law"] in flat and effect["meaning"] in flat
    assert "3.191 to 3.297" in flat and "is at its lower bound" in flat
    assert f"backlash on {JOINTS[3]} raises the error of joint4" in flat
    assert "arm.csv: a gap of 2 s at row 118" in flat
    assert "every validation log" in flat and "first.csv" in flat and "grew" in flat
    flat = " ".join(printed(unexplained(), monkeypatch, capsys).split())
    assert "2.5-3.5 s of log 1" in flat and re.search(rf"{JOINTS[3]} .{{0,60}} far", flat)


def test_one_law_on_all_joints_is_one_table(monkeypatch, capsys):
    told = explained()
    told["effects"] = [effect(joint=joint) for joint in JOINTS]
    out = printed(told, monkeypatch, capsys)
    assert out.count("3.191 to 3.297") == 7 and "\u2026" not in out
    flat = " ".join(out.split())
    assert flat.count(told["effects"][0]["meaning"]) == 1
    assert "The model lacked stribeck_friction on every joint (error" in flat
    assert re.search(rf"{JOINTS[6]} df 3.244 3.191 to 3.297 N m", flat)


def test_what_the_log_does_not_tell_from_what_is_named_stands_beside_the_name():
    told, (joint, next_joint) = explained(), JOINTS[1:3]

    def pair(place, named, other, rival):
        rival = {"effect": other, **rival}
        how = {"experiment": "move it further"}
        return {"joint": place, "effects": [named, other], "rival": rival, **how}

    cable = {"joint": next_joint, "other": joint}
    told["undecided"] = [
        pair(joint, "encoder_offset", "backlash", {"joint": joint}),
        pair(joint, "encoder_offset", "joint_elasticity", {"joint": joint}),
        pair(None, "torque_lag", "time_delay", {"joint": None}),
        pair(joint, "drive_gain", "cable_coupling", cable),
    ]
    said = evidence_sentence(told)
    assert (
        f"; this log does not tell encoder_offset from backlash or joint_elasticity on {joint};"
        in said
    )
    assert "; this log does not tell torque_lag from time_delay;" in said
    assert "To tell torque_lag from time_delay apart: move it further." in next_steps(told)
    both = f"drive_gain on {joint} from cable_coupling on {next_joint} (driven by {joint})"
    assert f"; this log does not tell {both} (error" in said
    assert f"To tell {both} apart: move it further." in next_steps(told)


@pytest.mark.parametrize("name", ["$x_{$", "[/b]", "a/b", "=1+1", "<script>", "\u03c6 1"])
def test_odd_names_are_printed_as_they_are(name, monkeypatch, capsys):
    told = json.loads(json.dumps(explained()).replace(JOINTS[1], name))
    out = printed(told, monkeypatch, capsys)
    assert f"stribeck_friction on {name}" in " ".join(out.split())


def test_a_bound_is_told_in_the_unit_of_the_joint():
    known = REGISTRY["stribeck_friction"].parameters[1]
    row = {"value": known.lower, "std_error": 0.001, "unit": "m/s"}
    assert parameter_remark(row, known) == "is at its lower bound, 0.005 m/s"
    beyond = parameter_remark(row | {"value": -1.0}, known)
    assert "outside of what physics allows" in beyond and "m/s" in beyond
    assert parameter_remark(row | {"value": 0.1}, known) == ""


def test_names_and_units_of_a_change_stand_whole(monkeypatch, capsys):
    told = changed()
    moved = row(28.67, 0.12, "N s/m") | {"before": 30.0, "change": row(-1.33, 0.12, "N s/m")}
    told["changed"][0]["parameters"] = {"b": moved}
    out = printed(told, monkeypatch, capsys)
    assert re.search(r"parameter +value", out) and "N s/m" in out
    assert "28.43 to 28.91" in out and "-1.57 to -1.09" in out


def test_a_pure_number_has_no_unit_and_an_interval():
    row = {"value": 1.091, "std_error": 0.012, "unit": "1"}
    assert value_text(row) == "1.091 (95 %: 1.067 to 1.115)"
    change = {"value": 0.5, "std_error": None, "unit": "N m"}
    told = value_text(
        {"value": 2.0, "std_error": None, "unit": "N m", "before": 1.5, "change": change}
    )
    assert told == "2 N m, was 1.5 N m: changed by 0.5 N m"


def test_formulas_are_offered_where_the_catalog_may_fall_short():
    def offered(told):
        return [step for step in next_steps(told) if "--discover" in step]

    told = explained()
    assert offered(told) == []
    blind = unexplained()
    assert offered(blind) == []
    blind["unexplained"][0]["depends_on"] = ["q_joint1"]
    assert f"what {JOINTS[3]} lacks" in offered(blind)[0]
    told["effects"].append(effect() | {"effect": "torque_ripple"})
    assert JOINTS[1] in offered(told)[0]
    told["effects"][1]["effect"] = "coulomb_friction"  # what every drive has
    assert offered(told) == []
    told["effects"][1]["effect"] = "torque_ripple"
    told["no_formula"] = [
        {"joint": JOINTS[1], "programs_tried": 3000, "because": "laws explain it"}
    ]
    assert offered(told) == []


def test_what_a_log_cannot_show_is_not_told_as_no_known_law():
    """A tilted base at 63 times the noise was said to be explained by none, and its joint to be looked at."""
    told = unexplained()
    refused = {"effect": "base_tilt", "joint": None, "because": UNSHOWN, "unshown": True}
    told["refused"] = [refused, {**refused, "effect": "backlash", "unshown": False}]
    sentence = evidence_sentence(told)
    assert "that this log cannot show (base_tilt would help," in sentence
    assert "no known law" not in sentence
    assert not [step for step in next_steps(told) if step.startswith(("Look at", "Vary"))]
    told["refused"] = []
    assert "no known law" in evidence_sentence(told)


def test_what_would_have_helped_a_joint_is_not_told_once_others_have():
    told = unexplained()
    refused = {"effect": "joint_spring", "joint": JOINTS[0], "because": UNSHOWN, "unshown": True}
    told["refused"] = [refused]
    for over, helps in ((3.0, True), (0.9, False)):
        told["residual_over_noise"][0] = over
        assert ("joint_spring on" in evidence_sentence(told)) == helps


def test_a_candidate_that_only_more_data_can_confirm_is_offered():
    """A drift that would take off 82 % of a joint at 19 times its noise stood in no sentence."""
    told = unexplained()
    joint = told["unexplained"][0]["joint"]
    one = {"effect": "thermal_drift", "joint": joint, "share_of_error": 0.82, "p_value": 0.0035}
    chance = {**one, "rejected_because": ["may be chance, given how many candidates were asked"]}
    cases = {
        "told": chance,
        "too little": {**chance, "share_of_error": 0.3},
        "elsewhere": {**chance, "joint": "another"},
        "against physics": {**one, "rejected_because": [*chance["rejected_because"], "x"]},
    }
    for kind, item in cases.items():
        told["not_added"] = [item]
        offered = [step for step in next_steps(told) if "thermal_drift" in step]
        assert len(offered) == (kind == "told"), kind
    told["not_added"] = [chance]
    (line,) = [step for step in next_steps(told) if "thermal_drift" in step]
    assert f"82 % of the error of {joint}" in line and "p = 0.0035" in line


def test_no_joint_is_done_that_is_left_above_its_noise_where_it_was_fitted():
    error = {"after": {"rms": [0.1, 0.1]}, "noise_floor": {"rms": [0.2, 0.2]}}
    result = {"joints": ("a", "b"), "residual_over_noise": [0.9, 3.8], "error": error}
    assert near_noise(result) == ["a: within 0.9 times the torque's noise: stop there."]
