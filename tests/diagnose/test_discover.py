"""A law that nobody wrote down is found as a formula, proven, carried by the model; else nothing is added."""

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from planted import added, declared_fit, diagnose_log, log_with

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.discovery.discover import discover
from jaxswarm.diagnose.discovery.grammar import MOST_CONSTANTS, programs, skeleton
from jaxswarm.diagnose.discovery.machine import DEPTH, LENGTHS, stack_depth
from jaxswarm.diagnose.discovery.problem import joint_problem
from jaxswarm.diagnose.discovery.sums import polished, unexplained
from jaxswarm.diagnose.report.result import to_result
from jaxswarm.diagnose.report.text import next_steps, verdict_sentence
from jaxswarm.diagnose.selection import add_best
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.outcome import outcome_of
from jaxswarm.effects.dimensions import parse_unit, unit_of
from jaxswarm.effects.formula import DISCOVERED
from jaxswarm.effects.postfix import check_program, fields_of
from jaxswarm.identify import load_model, model_torque, save_model
from jaxswarm.logs.motion import prepare
from jaxswarm.simulate import make_plant

LAWS = {
    "magnet": lambda q, dq: 6.0 * np.sin(q[:, 1]) * np.exp(-((q[:, 1] / 0.25) ** 2)),
    "product": lambda q, dq: 1.5 * q[:, 1] * dq[:, 1],
    "partner": lambda q, dq: 2.0 * np.sin(2 * q[:, 0]) * np.tanh(dq[:, 1] / 0.01),
    "two": lambda q, dq: 1.5 * q[:, 1] * dq[:, 1] + 3 * np.exp(-(((q[:, 1] - 0.3) / 0.1) ** 2)),
}
FIELDS = {
    "magnet": {"q"},
    "product": {"q", "dq"},
    "partner": {"q_other", "direction"},
    "two": {"q", "dq"},
}


def planted(name: str, motion_seed: int = 7):
    """A log with a law of no catalog on joint 2, from nearly exact positions."""
    log = log_with(motion_seed=motion_seed)
    dq = np.gradient(log.q, log.t, axis=0)
    extra = np.zeros_like(log.tau)
    extra[:, 1] = LAWS[name](log.q, dq)
    return replace(log, tau=log.tau + extra)


@cache
def searched(name: str):
    """The loop's outcome without, and with the search."""
    before = diagnose_log(planted(name))
    return before, *discover(before)


def error_elsewhere(found: Diagnosis, name: str) -> float:
    """RMS error of joint 2 on another motion with the same law."""
    motion = prepare(planted(name, motion_seed=8), found.final.model.filtering)
    left = motion.decimator.apply(motion.tau - model_torque(found.final.model, motion))
    return float(np.sqrt((left[:, 1] ** 2).mean()))


@pytest.mark.parametrize("name", sorted(LAWS))
def test_a_law_of_no_catalog_is_found(name):
    before, after, search = searched(name)
    (one,) = search.found
    assert not search.vain
    assert one.added.effect == DISCOVERED and one.added.joint == 1
    assert set(one.added.formula.fields) == FIELDS[name]
    assert error_elsewhere(after, name) < 0.35 * error_elsewhere(before, name)
    assert error_elsewhere(after, name) < 0.1  # the noise of the log is 0.1 before the low-pass


def test_what_stood_in_for_the_law_is_taken_back(monkeypatch):
    """As if a ripple of few periods had been believed."""
    monkeypatch.setattr(add_best, "one_place", lambda *a: None)
    before = diagnose_log(planted("magnet"))
    after, _ = discover(before)
    assert added(before), "a law of the catalog is bent to the magnet"
    assert added(after) == [] and {t.effect for t in after.withdrawn} == {
        e for e, _ in added(before)
    }


def test_values_and_units_of_the_magnet():
    _, _, search = searched("magnet")
    term = search.found[0].added
    values = dict(zip("as", (6.0, 0.25), strict=True))
    units = {p.name: p.unit for p in term.formula.parameters}
    assert units == {"a": "N m/rad", "s": "rad"}
    for name, value in values.items():
        assert term.values[name] == pytest.approx(value, rel=0.03)


def test_every_constant_of_a_formula_has_the_unit_that_makes_it_sound():
    for name in LAWS:
        formula = searched(name)[2].found[0].added.formula
        inner = {p.name: parse_unit(p.unit) for p in formula.parameters if not p.linear}
        for program, p in zip(formula.terms, formula.parameters, strict=False):
            unit = {**unit_of(program, inner)}
            for symbol, power in parse_unit(p.unit).items():
                unit[symbol] = unit.get(symbol, 0) + power
            assert {k: n for k, n in unit.items() if n} == {"N m": 1}


def test_a_clean_log_gets_no_formula():
    before = diagnose_log(log_with())
    after, search = discover(before)
    assert after is before and search == ((), ())


def test_what_is_only_noise_in_time_is_refused():
    log = log_with()
    rng = np.random.default_rng(4)
    walk = np.cumsum(rng.normal(size=len(log.t))) * 0.03
    extra = np.zeros_like(log.tau)
    extra[:, 1] = walk - walk.mean()
    found, crossfit = declared_fit(replace(log, tau=log.tau + extra))
    _, search = discover(Diagnosis(found, found, (), (), crossfit, 50))
    assert [one for one in search.found if "t" not in one.added.formula.fields] == []


def test_the_form_is_stated():
    told = {name: searched(name)[2].found[0].chosen.symmetry for name in LAWS}
    assert told["magnet"].kinds == ("potential force",) and "potential" in told["magnet"].text
    assert told["product"].parity == "odd" and told["product"].driving > 0.2
    assert "drives" in told["product"].text
    assert set(told["two"].kinds) == {"potential force", "friction"}


def test_the_model_file_carries_the_formula(tmp_path):
    for name in ("magnet", "partner"):
        model = searched(name)[1].final.model
        save_model(model, tmp_path / "model.json")
        again = load_model(tmp_path / "model.json")
        motion = prepare(planted(name, motion_seed=9), model.filtering)
        np.testing.assert_array_equal(model_torque(again, motion), model_torque(model, motion))
        assert again.terms == model.terms
        plant = make_plant(again.robot, again.terms, width=again.width)
        assert plant.acting[-1].law is model.terms[-1].law


def test_a_damaged_formula_in_a_model_file_is_refused(tmp_path):
    path = tmp_path / "model.json"
    save_model(searched("magnet")[1].final.model, path)
    content = json.loads(path.read_text())
    content["terms"][-1]["formula"]["terms"][0] = ["q", "eval"]
    path.write_text(json.dumps(content))
    with pytest.raises(ValueError, match=r"model.json: terms\[4\].formula: unknown token 'eval'"):
        load_model(path)


def test_the_result_tells_the_law_its_evidence_and_what_fits_alike():
    _, after, search = searched("magnet")
    result = to_result(outcome_of(after, laws=search.found), search=search)
    (entry,) = result["discovered"]
    assert entry["joint"] == "joint2" and entry["formula"] == "a*q_joint2*exp(-(q_joint2/s)^2)"
    assert entry["latex"].startswith(r"a\,q_{\mathrm{joint2}}")
    row = entry["parameters"]["a"]
    assert row["interval_95"][0] < row["value"] < row["interval_95"][1] and row["unit"] == "N m/rad"
    assert entry["range"][0]["variable"] == "q_joint2"
    assert entry["gain"]["p_value"] * entry["programs_tried"] < 0.01
    told = {one["formula"] for one in entry["alternatives"]}
    assert "a*sin(q_joint2)*exp(-(q_joint2/s)^2)" in told
    assert all(one["distance"]["over_noise"] < 0.5 for one in entry["alternatives"])
    assert result["verdict"] == "explained" and result["effects"] == []
    assert result["steps"][-1]["added"] == {"effect": DISCOVERED, "joint": "joint2"}
    assert entry["formula"] in verdict_sentence(result)
    assert any("To tell" in line for line in next_steps(result))


def test_programs_are_sound_and_none_is_there_twice():
    found, crossfit = declared_fit(log_with())
    problem = joint_problem(Linearization(found, crossfit), 1, 0)
    pieces = programs(problem.data, problem.units, problem.angles)
    assert len({skeleton(one.program) for one in pieces}) == len(pieces) > 10_000
    for one in pieces[:: len(pieces) // 400]:
        check_program(one.program, [p.name for p in one.constants])
        assert len(one.constants) <= MOST_CONSTANTS and len(one.program) <= LENGTHS[-1]
        assert stack_depth(one.program) <= DEPTH and set(fields_of(one.program)) <= set(
            problem.data
        )
        unit_of(one.program, {p.name: parse_unit(p.unit) for p in one.constants}, problem.units)


def test_constants_are_refined_to_the_least_residual():
    found, crossfit = declared_fit(planted("magnet"))
    problem = joint_problem(Linearization(found, crossfit), 1, None)
    formula = searched("magnet")[2].found[0].chosen.formula

    def left(s: float) -> float:
        return float(
            (unexplained(problem, formula._replace(values={"s": s}), crossfit.whole) ** 2).sum()
        )

    near = formula._replace(values={"s": 0.4})
    best = polished(problem, near, crossfit.whole).values["s"]
    assert left(best) <= min(left(0.99 * best), left(1.01 * best)) < left(0.4)
