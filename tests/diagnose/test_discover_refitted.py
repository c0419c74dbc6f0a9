"""Of formulas that fit alike the one is told that describes the log shortest once all is refitted."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from planted import declared_fit, log_with

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.discovery import joint_search, refitted
from jaxswarm.diagnose.discovery.front import Point, point, region_folds
from jaxswarm.diagnose.discovery.partner import named_partners
from jaxswarm.diagnose.discovery.pieces import Piece
from jaxswarm.diagnose.discovery.problem import joint_problem
from jaxswarm.diagnose.discovery.rivals import near_ones
from jaxswarm.diagnose.discovery.sums import Sum
from jaxswarm.effects.parameter import Parameter
from jaxswarm.identify.forward.finite_columns import Diverged
from jaxswarm.identify.forward.regression import Regression

ROWS = 400
CENTER = Parameter("c", "rad", -1.0, 1.0, False, 0.1, "center")
SINE = Piece(("q", "c", "-", "sin", "pos", "load", "*"), (CENTER,))
HINGE = Piece(("q", "c", "-", "pos", "load", "*"), (CENTER,))
LEVER = Piece(("q", "c", "-", "abs", "ddq", "*"), (CENTER,))
NOISE = np.random.default_rng(0).normal(size=(ROWS, 2))


def point_of(piece: Piece, error: float, bits: float) -> Point:
    formula = Sum((piece,), {"c": 0.1})
    return Point(formula, error, bits, np.sqrt(error) * NOISE[:, 0], None)


def model_that_leaves(size: float) -> SimpleNamespace:
    residual = NOISE * np.array([size, 1.0])
    moving, t, log = np.ones(residual.shape, bool), 0.01 * np.arange(ROWS), np.zeros(ROWS, int)
    regression = Regression((), np.zeros((ROWS, 2, 0)), residual, moving, t, log, (0.01,))
    return SimpleNamespace(
        regression=regression,
        fit=SimpleNamespace(residual=residual),
        model=SimpleNamespace(terms=()),
    )


def asked(monkeypatch, leaves: dict, points: list[Point]) -> list[tuple]:
    """Programs of the formulas that are better than the first, by what the refitted model with each leaves."""

    def refit(after, terms):
        size = leaves[terms[-1]]
        if size is None:
            raise Diverged
        return model_that_leaves(size)

    monkeypatch.setattr(refitted, "refit", refit)
    monkeypatch.setattr(refitted, "without", lambda term, terms: terms)
    monkeypatch.setattr(refitted, "as_term", lambda problem, formula: formula.programs[0])
    after = model_that_leaves(leaves[points[0].formula.programs[0]])
    fits = refitted.alike_refitted(None, points[0], points[1:], after, None)
    return [p.formula.programs[0] for p in refitted.shorter(fits)]


@pytest.mark.parametrize(
    ("hinge", "better"), [(0.97, True), (1.0, True), (1.03, False), (None, False)]
)
def test_what_the_refitted_model_leaves_decides(monkeypatch, hinge, better):
    """Though the sine left less in the model that lacked the law; where they leave as much, the shorter one."""
    points = [point_of(SINE, 8e-4, 43.0), point_of(HINGE, 9e-4, 38.0)]
    told = asked(monkeypatch, {SINE.program: 1.0, HINGE.program: hinge}, points)
    assert told == ([HINGE.program] if better else [])


def test_what_a_wrong_formula_leaves_is_counted_in_samples_of_the_right_one():
    """What is wrong is slow: by its own few samples ten times the noise was as good as the noise."""
    wrong, right = model_that_leaves(1.0), model_that_leaves(1.0)
    slow = 10.0 * np.sin(2.0 * np.pi * np.arange(ROWS) / ROWS)
    wrong.fit.residual[:, 0] += slow
    fits = [(point_of(SINE, 8e-4, 20.0), wrong), (point_of(HINGE, 8e-4, 60.0), right)]
    assert refitted.descriptions(fits)[1] < refitted.descriptions(fits)[0]


def test_a_formula_that_does_not_fit_alike_is_not_asked(monkeypatch):
    points = [point_of(SINE, 8e-4, 43.0), point_of(LEVER, 0.9, 38.0)]
    assert asked(monkeypatch, {SINE.program: 1.0, LEVER.program: 0.1}, points) == []


def test_of_formulas_that_say_the_same_the_first_is_asked(monkeypatch):
    points = [point_of(SINE, 8e-4, 43.0), point_of(HINGE, 9e-4, 38.0), point_of(LEVER, 9e-4, 43.0)]
    leaves = {SINE.program: 1.0, HINGE.program: 0.97, LEVER.program: 0.5}
    assert asked(monkeypatch, leaves, points) == [HINGE.program]


def test_a_form_that_was_found_twice_is_told_once():
    """A report named one rival three times, found by three ways to slightly other constants."""
    one, again = point_of(HINGE, 9e-4, 38.0), point_of(HINGE, 9.001e-4, 38.0)
    points = [point_of(SINE, 8e-4, 43.0), one, again, point_of(LEVER, 9e-4, 43.0)]
    assert near_ones(points[0], points) == [one, points[-1]]


@pytest.mark.parametrize("proved", [True, False])
def test_it_has_to_prove_itself_as_the_first_did(monkeypatch, proved):
    sine, hinge = point_of(SINE, 8e-4, 43.0), point_of(HINGE, 9e-4, 38.0)
    first, second = ("first", None, model_that_leaves(1.0)), ("second", None, None)
    monkeypatch.setattr(joint_search, "find_term", lambda after, term: term)
    monkeypatch.setattr(joint_search, "alike_refitted", lambda *given: [])
    monkeypatch.setattr(joint_search, "shorter", lambda fits: [hinge])
    monkeypatch.setattr(joint_search, "prove", lambda *given: second if proved else "it harms")
    now = SimpleNamespace(final=None)
    given = (now, SimpleNamespace(joint=0), None, sine, [sine, hinge], 10, ())
    told = joint_search._refitted(*given, first)
    assert told == ((hinge, second) if proved else (sine, first))


@pytest.mark.parametrize(("worst", "told"), [(0.5, ["hinge"]), (0.99, []), (1.5, [])])
def test_what_fits_alike_is_told_apart_by_other_motion(monkeypatch, worst, told):
    """The best on every other log, though the first says more of the one that was fitted."""
    left = {"sine": 1.0, "hinge": worst, "lever": 2.0}
    monkeypatch.setattr(refitted, "left_elsewhere", lambda fit, *given: left[fit])
    fits = [(name, name) for name in left]
    assert refitted.better_elsewhere(fits, None, 0, ["another log"]) == told
    assert refitted.better_elsewhere(fits, None, 0, ()) == []


def test_a_temperature_is_asked_where_time_is_named_and_time_costs_more_beside_it():
    assert named_partners(0, ("t",), ("a", "b")) == [(None, ["t", "temperature"])]
    hot = log_with()
    heat = np.repeat((20.0 + 30.0 * -np.expm1(-hot.t / 4.0))[:, None], 2, axis=1)
    warm = replace(hot, channels={**hot.channels, "temperature": heat})
    told = []
    for log in (hot, warm):
        fit, folds = declared_fit(log)
        wanted = ["t", "temperature"]
        problem = joint_problem(Linearization(fit, folds), 1, None, wanted)
        formula = Sum((Piece(("t", "dq", "*")),), {})
        whole = region_folds(folds.whole, folds.block)
        told.append(point(problem, formula, whole).bits)
    assert told[1] > told[0]


def test_a_law_is_searched_again_with_the_load_of_the_model_that_it_led_to():
    found, crossfit = declared_fit(log_with())
    pi = 1.3 * np.asarray(found.model.robot.parameters)
    heavier = replace(found.model, robot=found.model.robot.replace(parameters=pi))
    now = SimpleNamespace(final=found, crossfit=crossfit)
    own, other = (
        joint_search.problem_of(now, 1, None, [], seen)
        for seen in (None, replace(found, model=heavier))
    )
    for load in ("load", "static_load"):
        np.testing.assert_allclose(other.data[load], 1.3 * own.data[load], rtol=1e-6)
    np.testing.assert_allclose(other.lin.loads[0].full, 1.3 * own.lin.loads[0].full, rtol=1e-6)
    np.testing.assert_array_equal(other.data["dq"], own.data["dq"])
