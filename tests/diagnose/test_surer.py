"""What the data do not tell apart: the law whose number is certain is told, and what gains more with it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from planted import declared_fit, log_with

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.rules import PRICE
from jaxswarm.diagnose.selection import instead
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.outcome import outcome_of
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import step_between
from jaxswarm.diagnose.selection.tenable import is_certain
from jaxswarm.effects.term import Term


@pytest.mark.parametrize(
    ("effect", "values", "certain"),
    [
        ("encoder_offset", {"dq0": 0.021}, False),
        ("encoder_offset", {"dq0": 0.04}, True),
        ("drive_gain", {"gain": 1.02}, False),
        ("drive_gain", {"gain": 0.94}, True),
        ("base_tilt", {"gx": 0.03, "gy": -0.02}, False),
        ("base_tilt", {"gx": 0.03, "gy": -0.06}, True),
        ("joint_spring", {"k": 0.03, "tau0": 0.0}, False),
        ("joint_elasticity", {"k": 120.0, "d": 0.0}, True),
        ("backlash", {"gap": 0.011, "flank": 30.0}, False),
        ("backlash", {"gap": 0.05, "flank": 30.0}, True),
        ("contact", {"start": 0.4, "end": 0.6, "tau_joint1": -0.01, "tau_joint2": 0.03}, False),
        ("contact", {"start": 0.4, "end": 0.6, "tau_joint1": -0.01, "tau_joint2": 0.06}, True),
    ],
)
def test_what_has_no_linear_coefficient_is_certain_by_what_does_nothing(effect, values, certain):
    """An encoder's zero of 0.021 +- 0.017 rad was told, for only linear coefficients had to be certain."""
    term = Term(effect, None if effect in ("base_tilt", "contact") else 1, values=values)
    assert is_certain(term, dict.fromkeys(values, 0.017)) == certain
    assert is_certain(term, dict.fromkeys(values, np.nan))


@pytest.mark.parametrize(
    ("error", "left", "told"), [(0.9, 1.0, True), (4.0, 1.0, False), (0.9, 1.1 * PRICE, False)]
)
def test_of_laws_that_leave_the_same_the_certain_one_is_told(monkeypatch, error, left, told):
    cable = Term("cable_coupling", 1, 0, values={"kc": -6.1, "k": 0.0, "tau0": 0.0})
    pick = SimpleNamespace(candidate=SimpleNamespace(term=cable), joint=1)
    errors = {"kc": error, "k": 1.0, "tau0": 1.0}
    model = SimpleNamespace(terms=(cable,))
    fit = SimpleNamespace(model=model, std_errors=(errors,), left=left)
    current = SimpleNamespace(left=1.0)
    monkeypatch.setattr(instead, "fitted_pick", lambda rest, pick, seed: (pick, fit))
    monkeypatch.setattr(instead, "cost", lambda found, joint, weights: found.left)
    found = instead.surer([pick], None, current, ())
    assert found == ((pick, fit) if told else None)


@pytest.fixture(scope="module")
def drag():
    """A drag that was told, and Stribeck friction and a coupling beside it."""
    before, crossfit = declared_fit(log_with(Term("quadratic_drag", 1, values={"c": 1.5})))
    asked = [Term("quadratic_drag", 1), Term("nonlinear_viscous_friction", 1)]
    drag, power = score_terms(Linearization(before, crossfit), asked, 0)
    return before, crossfit, refit_with(before, drag), drag, power


@pytest.mark.parametrize(("part", "told"), [(1.3, True), (1.05, False)])
def test_a_runner_up_that_gains_more_is_not_told_from_what_was_added(drag, part, told):
    """An addition stood as certain beside runners-up of 6.3 and 4.8 times its gain, which may be chance."""
    before, crossfit, after, score, power = drag
    gains = power.per_joint * (part * score.per_joint[1] / power.per_joint[1])
    chance = replace(power, per_joint=gains, p_value=0.01)
    step = step_between(score, before, after, others=(chance,))
    found = outcome_of(Diagnosis(before, after, (step,), (), crossfit, 60))
    assert [u.rival.candidate.term.effect for u in found.undecided] == (
        ["nonlinear_viscous_friction"] if told else []
    )
    weak = replace(step, others=(replace(chance, share=0.1),))
    changed = replace(step, rest=after.model)
    for one in (weak, changed):
        assert not outcome_of(Diagnosis(before, after, (one,), (), crossfit, 60)).undecided
