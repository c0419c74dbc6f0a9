"""Terms are tried in the other shapes of their variables; signs are seen through the torque's low-pass."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from planted import declared_fit, log_with

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.discovery import seen_again
from jaxswarm.diagnose.discovery.as_term import as_term
from jaxswarm.diagnose.discovery.front import point, region_folds
from jaxswarm.diagnose.discovery.nearby import nearby
from jaxswarm.diagnose.discovery.pieces import Piece
from jaxswarm.diagnose.discovery.problem import joint_problem
from jaxswarm.diagnose.discovery.reach import tame
from jaxswarm.diagnose.discovery.seen_again import alike_in_form, shapes_of
from jaxswarm.diagnose.discovery.sums import Sum
from jaxswarm.diagnose.discovery.term_more import believed
from jaxswarm.diagnose.folds.other_motion import regions
from jaxswarm.effects.postfix import evaluate

BRAKE, CAM = Piece(("q", "sin", "dq", "*")), Piece(("q_other", "cos", "ddq", "*"))
BENT_BRAKE, BENT_CAM = Piece(("q", "cube", "dq", "*")), Piece(("q_other", "abs", "ddq", "*"))
WAVE = Piece(("q", "2", "*", "sin", "dq", "abs", "*"))
FAR = Piece(("ddq", "load", "*"))
WILD = Piece(("q", "square", "dq", "cube", "*", "ddq", "square", "*"))
TAMER = Piece(("q", "dq", "*", "ddq", "abs", "*"))
PIECES = [BENT_BRAKE, BENT_CAM, WAVE, FAR, CAM, BRAKE, TAMER, WILD]


@cache
def fit():
    return declared_fit(log_with())


def lacking(torque):
    """Joint 2, where a torque of its variables is all that the model lacks, and the regions of the log."""
    found, crossfit = fit()
    plain = joint_problem(Linearization(found, crossfit), 1, 0)
    column = plain.lin.on_joint(torque(plain.data)[:, None], 1)
    whole = replace(crossfit.whole, residual=crossfit.whole.free_part(column)[:, :, 0])
    lin = Linearization(found, replace(crossfit, whole=whole))
    return joint_problem(lin, 1, 0), region_folds(whole, regions(found))


def two(x):
    return 4.0 * np.sin(x["q"]) * x["dq"] + np.cos(x["q_other"]) * x["ddq"]


def test_both_terms_of_a_sum_come_to_their_shapes():
    problem, folds = lacking(two)
    bent = point(problem, Sum((BENT_BRAKE, BENT_CAM), {}), folds)
    found, tried = nearby(problem, PIECES, [bent], folds, 0)
    best = min(found, key=lambda one: one.error)
    assert set(best.formula.programs) == {BRAKE.program, CAM.program}
    assert best.error < 1e-6 < bent.error
    assert all(FAR not in one.formula.pieces for one in found)
    assert tried % 5 == 0  # three shapes of the one's variables, two of the other's


@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_what_explodes_is_believed_only_where_it_explains_everything(noise):
    rng = np.random.default_rng(0)

    def torque(x):
        law = x["q"] ** 2 * x["dq"] ** 3 * x["ddq"] ** 2
        return law + noise * np.std(law) * rng.normal(size=law.shape)

    problem, folds = lacking(torque)
    start = point(problem, Sum((TAMER,), {}), folds)
    found, _ = nearby(problem, PIECES, [start], folds, 0)
    wild = point(problem, Sum((WILD,), {}), folds)
    assert not tame(problem, wild.formula)
    assert believed(problem, wild) is (noise == 0.0)
    assert any(one.formula.pieces == (WILD,) for one in found) is (noise == 0.0)


@pytest.mark.parametrize(("of_left", "there"), [(1.0, True), (0.5, False)])
def test_noise_is_no_part_of_what_an_exploding_law_leaves(of_left, there):
    """dq^5 load0^2 on a joint at five times its noise left the noise, and was refused for that."""
    law, rng = WILD.program, np.random.default_rng(0)

    def torque(x):
        said = evaluate(law, x, np)
        return said + 0.25 * np.std(said) * rng.normal(size=said.shape)

    problem, folds = lacking(torque)
    wild = point(problem, Sum((WILD,), {}), folds)
    weight, crossfit = problem.lin.crossfit.weight[:, 1], problem.lin.crossfit
    left = np.sqrt(np.mean((wild.left / weight) ** 2))
    noise = np.where(np.arange(2) == 1, of_left * left, crossfit.noise[:2])
    problem.lin.crossfit = replace(crossfit, noise=noise)
    assert wild.error > 0.02
    assert believed(problem, wild) is there


def test_a_law_is_told_in_the_shortest_shape_that_says_as_much(monkeypatch):
    problem, _ = lacking(two)
    monkeypatch.setattr(seen_again, "programs", lambda *args: PIECES)
    bent = Sum((BENT_CAM, BENT_BRAKE), {})
    points, _ = shapes_of(problem, [bent], regions(problem.lin.found), 0)
    assert alike_in_form(points[0].formula, Sum((BRAKE, CAM), {}))
    assert not alike_in_form(points[0].formula, bent)
    again, _ = shapes_of(problem, [points[0].formula], regions(problem.lin.found), 0)
    assert alike_in_form(again[0].formula, points[0].formula)


def test_a_sign_is_seen_as_the_low_pass_leaves_it():
    problem, _ = lacking(two)
    formula = Sum((Piece(("q", "sin", "direction", "*")),), {})
    exact = problem.lin.law(as_term(problem, formula))[:, 1, 0]
    seen = problem.columns(formula.programs, {})[:, 1, 0]
    assert np.linalg.norm(seen - exact) < 0.05 * np.linalg.norm(exact)
