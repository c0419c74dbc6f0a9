"""Rows in which joints hardly move, left out until a law is found that explains them too."""

from functools import cache

import numpy as np
import pytest
from planted import BAND, blank, log_with, search_of, small_arm

from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.selection import sticking_beside
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.diagnose.selection.sticking_beside import leave_out_beside_laws, put_back
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

LATE = Term("time_delay", values={"seconds": 0.015})


@cache
def late():
    """The declared model of a log whose torque is late, and the same with a delay."""
    log = prepare(log_with(LATE), BAND)
    declared = with_motion_noise(estimate(small_arm(), blank(), [log], bounded=False))
    told = refit(declared, (*declared.model.terms, Term("time_delay")))
    return declared, with_motion_noise(told)


@pytest.mark.parametrize("joint", [0, 1])
def test_a_law_of_the_whole_arm_is_one_of_any_joint(joint):
    """A filter showed most on a joint that nothing holds, and was not asked for the three that lacked it."""
    declared, _ = late()
    after = sticking_beside._with_law(search_of(declared), declared, {joint})
    assert after is not None
    assert after.model.terms[-1].effect == "time_delay"


def told_beside(monkeypatch, told):
    """As if motion alone brought the first joint near its noise with a law, and friction held nothing."""
    monkeypatch.setattr(sticking_beside, "loud_joints", lambda search: {0})
    monkeypatch.setattr(sticking_beside, "stands_out", lambda *of: np.array([True, True]))
    monkeypatch.setattr(sticking_beside, "_with_laws", lambda *of: told)
    monkeypatch.setattr(sticking_beside, "is_held", lambda *of: np.array([False, False]))


def test_rows_come_back_once_the_law_is_found_that_explains_them(monkeypatch):
    declared, told = late()
    told_beside(monkeypatch, told)
    search = search_of(declared)
    every = declared.regression.used_rows
    assert not put_back(search)
    assert leave_out_beside_laws(search)
    assert not search.sticking  # friction holds nothing
    assert search.current.regression.used_rows.sum() < every.sum()
    assert put_back(search)
    np.testing.assert_array_equal(search.current.regression.used_rows, every)
    # Once: it would go on for ever where the law is refused.
    assert not leave_out_beside_laws(search) and not put_back(search)


def test_rows_in_which_friction_was_found_to_hold_a_joint_stay_out(monkeypatch):
    """Two joints on a cable were left at 5 and 12 times their noise again, and the cable was taken back."""
    declared, told = late()
    told_beside(monkeypatch, told)
    search = search_of(declared)
    every = declared.regression.used_rows
    assert leave_out_beside_laws(search)
    without = search.current.regression.used_rows
    search.sticking.add(0)
    assert put_back(search)
    rows = search.current.regression.used_rows
    np.testing.assert_array_equal(rows[:, 0], without[:, 0])
    np.testing.assert_array_equal(rows[:, 1], every[:, 1])
    assert without[:, 0].sum() < every[:, 0].sum()


def test_rows_that_the_law_does_not_explain_stay(monkeypatch):
    declared, _ = late()
    told_beside(monkeypatch, declared)
    search = search_of(declared)
    assert not leave_out_beside_laws(search)
    assert search.current is declared


def test_rows_are_not_lent_for_a_law_that_was_refused_on_all_of_them(monkeypatch):
    """What another log had refused was asked once more, and six laws like it after that."""
    declared, told = late()
    told_beside(monkeypatch, told)
    search = search_of(declared)
    search.refuse(Term("time_delay"))
    assert not leave_out_beside_laws(search)
