"""A search that may take so long and no longer: what is known then is reported, and it can go on."""

import json
from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, added, blank, log_with, small_arm
from slide import run

import jaxswarm
from jaxswarm.diagnose import diagnose
from jaxswarm.diagnose.candidates.journal import FILE
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.report.result import to_result
from jaxswarm.diagnose.report.text import evidence_sentence, next_steps
from jaxswarm.diagnose.selection.budget import Budget
from jaxswarm.diagnose.selection.outcome import outcome_of
from jaxswarm.effects.term import Term
from jaxswarm.errors import InputError
from jaxswarm.identify.synthetic import demo_case, synthetic_log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import rx60

SPRING = Term("joint_spring", 0, values={"k": 6.0, "tau0": 1.0})
RIPPLE = Term("torque_ripple", 1, values={"sine": 0.5, "cosine": -0.4, "n": 17.0})


class Rounds(Budget):
    """A budget that is spent after so many rounds."""

    asked = 0

    @property
    def spent(self) -> bool:
        object.__setattr__(self, "asked", self.asked + 1)
        return self.asked > self.seconds


def search(budget):
    told = []
    motions = [prepare(log_with(SPRING, RIPPLE), BAND)]
    found = diagnose(small_arm(), blank(), motions, budget=budget, progress=told.append)
    return found, told


def test_a_spent_budget_ends_the_search_with_what_was_added_so_far():
    found, told = search(Rounds(2))
    assert found.spent.rounds == 2
    assert 1 <= len(added(found)) <= 2
    assert told[-1] == found.spent.sentence
    assert all(s.candidate.term.identity != found.steps[0].added.identity for s in found.last)
    result = to_result(outcome_of(found))
    assert result["budget"] == {"seconds": 2, "rounds": 2}
    assert any(reason.startswith("stopped by the budget") for reason in result["reasons"])


def test_no_time_at_all_still_tells_of_the_declared_model():
    found, _ = search(Budget(1e-6))
    assert found.spent.rounds == 0 and added(found) == [] and found.last == ()
    result = to_result(outcome_of(found), rules=Rules())
    assert result["verdict"] == "unexplained"
    assert "the budget left no time for" in evidence_sentence(result)
    # No law was asked: nobody may say that none explains it.
    assert "no known law" not in " ".join(next_steps(result))


def test_a_budget_that_suffices_is_not_told():
    log = log_with(seed=21)
    found = diagnose(small_arm(), blank(), [prepare(log, BAND)], budget=Budget(1e6))
    assert found.spent is None and to_result(outcome_of(found))["budget"] is None


@pytest.fixture
def log_file(tmp_path):
    arm, declared, hidden = demo_case(rx60(), 3)
    log = synthetic_log(arm, (*declared, *hidden), 3, duration=10.0, rate=125.0)
    path = tmp_path / "arm.npz"
    np.savez(path, t=log.t, q=log.q, tau=log.tau, joints=np.array(log.joints))
    return path


def test_the_command_reports_and_the_same_command_goes_on(tmp_path, log_file):
    out = tmp_path / "out"
    given = "diagnose", log_file, "--robot", "rx60", "--out", out
    given = *given, "--declare", "viscous_friction,coulomb_friction"
    code, text, err = run(*given, "--budget", "0.001")
    assert code == 0, err
    assert "stopped by the budget of 0.001 s after 0 rounds" in text.replace("\n", " ")
    result = json.loads((out / "diagnosis.json").read_text())
    assert result["budget"] == {"seconds": 0.001, "rounds": 0} and result["effects"] == []
    assert "stopped by the budget" in (out / "report.html").read_text()
    assert run(*given)[0] == 0
    result = json.loads((out / "diagnosis.json").read_text())
    assert result["budget"] is None and result["verdict"] == "explained"
    assert not (out / FILE).exists()


def test_against_an_earlier_model(tmp_path, log_file):
    model = tmp_path / "earlier"
    options = "--robot", "rx60", "--out"
    effects = "viscous_friction,coulomb_friction"
    assert run("identify", log_file, *options, model, "--effects", effects)[0] == 0
    out, given = tmp_path / "out", ("--model", model / "model.json", "--budget", "0.001")
    assert run("diagnose", log_file, *options, out, *given)[0] == 0
    result = json.loads((out / "diagnosis.json").read_text())
    assert result["budget"]["rounds"] == 0 and result["changed"] == []


def test_from_python():
    log = log_with(SPRING)
    found = jaxswarm.diagnose(log, small_arm(), "viscous_friction", budget=1e-3)
    assert any("stopped by the budget" in line for line in found.content["reasons"])
    with pytest.raises(InputError, match="budget 0: give seconds"):
        jaxswarm.diagnose(replace(log), small_arm(), budget=0)


@pytest.mark.parametrize("seconds", ["0", "-3", "nan", "inf", "soon"])
def test_budgets_that_are_none(tmp_path, log_file, seconds):
    given = "diagnose", log_file, "--robot", "rx60", "--out", tmp_path / "out"
    code, _, err = run(*given, "--budget", seconds)
    assert code == 2 and "--budget" in err
    assert not (tmp_path / "out").exists()
