"""Laws are asked of motion alone first where most is left at rest and motion lacks a law."""

import numpy as np
import pytest
from planted import BAND, blank, search_of, small_arm
from test_standing import sticking

from jaxswarm.diagnose import diagnose
from jaxswarm.diagnose.decision.remainder import over_noise, remainders
from jaxswarm.diagnose.selection import motion_first
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

SPRING = Term("joint_spring", 0, values={"k": 12.0, "tau0": 5.0})


@pytest.fixture
def near(monkeypatch):
    """Motion counts as far from its noise at a multiple that the small arm reaches."""
    monkeypatch.setattr(motion_first, "LOST", 2.5)


def begun(*hidden):
    """A search on a log of joints that stick, before its first round."""
    return search_of(estimate(small_arm(), blank(), [prepare(sticking(0, 2.0, *hidden), BAND)]))


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


def test_a_search_that_finds_nothing_in_motion_is_forgotten(near):
    assert motion_first.found_in_motion(begun(SPRING), lambda one: None) is None


def test_a_law_beside_much_stiction_is_told_with_its_values(near):
    found = diagnose(small_arm(), blank(), [prepare(sticking(0, 2.0, SPRING), BAND)])
    assert [(s.added.effect, s.added.joint) for s in found.kept] == [("joint_spring", 0)]
    assert found.kept[0].added.values["k"] == pytest.approx(12.0, rel=0.02)
    assert np.max([r.over_noise for r in remainders(found.final)]) < 1.3
