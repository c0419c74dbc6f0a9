"""A law that contains others gives way to one of them once what bent it is in the model."""

import pytest
from planted import declared_fit, log_with

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.selection import reselect as reselect_module
from jaxswarm.diagnose.selection.refit import refit_in_place
from jaxswarm.diagnose.selection.reselect import reconsider
from jaxswarm.diagnose.selection.step import step_between
from jaxswarm.effects.term import Term

SPRING = Term("joint_spring", 1, values={"k": 25.0, "tau0": 2.0})


@pytest.fixture(scope="module")
def told_as_cable():
    """A spring told as a cable from the first joint, beside which no spring came near."""
    before, crossfit = declared_fit(log_with(SPRING))
    terms = [Term("cable_coupling", 1, 0), Term("cubic_spring", 1)]
    ones = score_terms(Linearization(before, crossfit), terms, 0)
    return step_between(ones[0], before, refit_in_place(before, ones[0].candidate.term)), ones[1]


@pytest.mark.parametrize(
    "another", [False, True], ids=["asked", "another law ahead, which leaves more"]
)
def test_a_cable_that_is_a_spring_is_told_as_one(told_as_cable, monkeypatch, another):
    step, cubic = told_as_cable
    choose = reselect_module.choose
    ahead = (lambda *rest: (cubic, [])) if another else choose
    monkeypatch.setattr(reselect_module, "choose", ahead)
    steps, found, changed = reconsider([step], step.after, 60, Rules())
    assert changed and [s.added.effect for s in steps] == ["joint_spring"]
    assert steps[0].added.values["k"] == pytest.approx(25.0, rel=0.05)
    assert "cable_coupling" not in {t.effect for t in found.model.terms}
