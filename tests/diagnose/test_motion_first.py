"""Laws are asked of motion alone first where most is left at rest and motion lacks a law."""

from importlib import import_module

import numpy as np
import pytest
from planted import BAND, blank, search_of, small_arm
from test_standing import sticking
from test_take_back import add

from jaxswarm.diagnose import diagnose
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.remainder import over_noise, remainders
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection import motion_first
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

add_best_of = import_module("jaxswarm.diagnose.selection.add_best")
sticking_rows = import_module("jaxswarm.diagnose.selection.sticking")

SPRING = Term("joint_spring", 0, values={"k": 12.0, "tau0": 5.0})


@pytest.fixture
def near(monkeypatch):
    """Motion counts as far from its noise at a multiple that the small arm reaches."""
    monkeypatch.setattr(motion_first, "LOST", 2.5)


def begun(*hidden):
    """A search on a log of joints that stick, before its first round."""
    return search_of(estimate(small_arm(), blank(), [prepare(sticking(0, 2.0, *hidden), BAND)]))


def with_folds(search):
    """As the first round begins."""
    search.current = with_motion_noise(search.current)
    search.crossfit = cross_fit(search.current)


def rows_of(search):
    return search.current.regression.used_rows.sum(axis=0)


def test_rest_is_lent_for_a_law_that_motion_lacks(near):
    search, seen = begun(SPRING), []
    every = rows_of(search)

    def run(one):
        seen.append((rows_of(one), over_noise(one.current)))
        one.steps.append("found")
        one.given_up = True  # nothing is taken back

    assert motion_first.found_in_motion(search, run) is search
    ((rows, over),) = seen
    assert (rows < every).all() and over[0] > 2.5 and over[1] < 1.0
    assert not any(m.held.any() for m in search.lent)
    assert not search.sticking


@pytest.mark.parametrize("hidden", [(), (SPRING,)], ids=["clean", "near"])
def test_nothing_is_asked_where_motion_is_not_far_from_its_noise(hidden):
    """Clean joints that bristles hold were left with four times their noise: they had false names by it."""
    search = begun(*hidden)
    assert motion_first.found_in_motion(search, pytest.fail) is None
    assert search.lent is None


@pytest.mark.parametrize(("added", "far"), [(True, 1.1), (True, 8.0), (False, 1.1)])
def test_what_was_added_is_not_judged_by_what_friction_holds(monkeypatch, added, far):
    """A cable that took 0.95 off its joint was taken back for what friction held: 12 times the noise."""
    monkeypatch.setattr(sticking_rows, "LOST", far)
    search = begun(SPRING)
    with_folds(search)
    if added:
        add(search, Term("joint_spring", 0))
    assert over_noise(search.current)[0] > 1.1
    before = rows_of(search)
    assert sticking_rows.leave_out_where_lost(search) == (added and far < 8.0)
    assert (rows_of(search) < before).any() == (added and far < 8.0)


def test_folds_are_those_of_the_model_when_rest_that_came_back_is_looked_at(monkeypatch):
    """A geometry that was added changed which parameters of links a log tells: the folds had one less."""
    search = begun(Term("drive_gain", 1, values={"gain": 1.3}))
    with_folds(search)
    search.lent = ()
    seen = []
    monkeypatch.setattr(
        add_best_of, "leave_out_sticks", lambda one: seen.append((one.current, one.folds))
    )
    monkeypatch.setattr(add_best_of, "why_not", lambda *told: "")
    for name in ("stands_in", "one_place", "worse_than_waves"):
        monkeypatch.setattr(add_best_of, name, lambda *told: None)
    lin = Linearization(search.current, search.folds)
    scores = score_terms(lin, [Term("drive_gain", 1)], 0)
    assert add_best_of.add_best(search, scores)
    ((current, folds),) = seen
    np.testing.assert_array_equal(folds.whole.residual, cross_fit(current).whole.residual)


def test_a_search_that_finds_nothing_in_motion_is_forgotten(near):
    assert motion_first.found_in_motion(begun(SPRING), lambda one: None) is None


def test_a_law_beside_much_stiction_is_told_with_its_values(near):
    found = diagnose(small_arm(), blank(), [prepare(sticking(0, 2.0, SPRING), BAND)])
    assert [(s.added.effect, s.added.joint) for s in found.kept] == [("joint_spring", 0)]
    assert found.kept[0].added.values["k"] == pytest.approx(12.0, rel=0.02)
    assert np.max([r.over_noise for r in remainders(found.final)]) < 1.3
