"""The second search, for a model of every row: it ends where it can have none."""

import importlib
from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, blank, log_with, search_of, small_arm

from jaxswarm.diagnose import diagnose
from jaxswarm.diagnose.selection import of_some_joints
from jaxswarm.diagnose.selection.sticking import give_up_if_it_sticks
from jaxswarm.identify import estimate
from jaxswarm.identify.estimation.standing import leave_out
from jaxswarm.logs.motion import prepare

SELECTION = "jaxswarm.diagnose.selection"
stepwise, sticking, with_rest = (
    importlib.import_module(f"{SELECTION}.{name}") for name in ("stepwise", "sticking", "with_rest")
)


@pytest.fixture(scope="module")
def motion():
    return prepare(log_with(), BAND)


@pytest.fixture(scope="module")
def found(motion):
    return estimate(small_arm(), blank(), [motion])


@pytest.mark.parametrize(
    ("ended", "sticks"), [(True, False), (True, True), (False, True), (False, False)]
)
def test_it_is_given_up_where_joints_stick_or_more_would_be_added(
    monkeypatch, found, ended, sticks
):
    """On a measured arm it went on with other rows for a sixth of the whole time; nobody looked at its end."""
    asked = []
    fit = found if sticks else None
    monkeypatch.setattr(sticking, "_fit_of_what_moves", lambda search: asked.append(search) or fit)
    monkeypatch.setattr(sticking, "go_on_from", None)
    search = search_of(found)
    search.ended = ended
    assert not give_up_if_it_sticks(search)
    assert search.given_up == (ended or sticks)
    assert bool(asked) != ended


def test_it_is_asked_that_in_the_place_of_other_rows(monkeypatch, motion, found):
    rest = np.zeros((len(found.regression.t), 2), bool)
    rest[:50] = True
    first = search_of(found)
    first.current = estimate(small_arm(), blank(), leave_out([motion], [rest], np.ones(2, bool)))
    given = []
    monkeypatch.setattr(with_rest, "standing", lambda motions: [rest])
    monkeypatch.setattr(with_rest, "over_noise", lambda found: np.array([3.0, 3.0]))
    with_rest.with_rest(first, [motion], lambda *of: given.append(of) or first)
    assert given[0][-1] is give_up_if_it_sticks


@pytest.mark.parametrize("rows", ["all", "moving", "lent"])
def test_it_is_not_made_where_the_first_began_with_all_rows(monkeypatch, motion, found, rows):
    """There it can only be given up: on a tilted base it found the tilt once more, for a third of the time."""
    rest = np.zeros((len(found.regression.t), 2), bool)
    rest[:50] = True
    alone = leave_out([motion], [rest], np.ones(2, bool))
    after = estimate(small_arm(), blank(), alone)
    first = search_of(after if rows == "moving" else found)
    first.lent = (motion,) if rows == "lent" else None
    monkeypatch.setattr(sticking, "_fit_of_what_moves", lambda search: after)
    monkeypatch.setattr(sticking, "take_back_told_at_rest", lambda *of: None)
    assert sticking.leave_out_sticks(first) and first.of_all_rows == (rows == "all")
    asked = []
    monkeypatch.setattr(with_rest, "standing", lambda motions: [rest])
    monkeypatch.setattr(with_rest, "over_noise", lambda found: np.array([3.0, 3.0]))
    with_rest.with_rest(first, [motion], lambda *of: asked.append(of) or first)
    assert bool(asked) == (rows != "all")


def test_what_is_asked_in_the_end_is_given(monkeypatch, motion):
    asked = []

    def second(search, motions, searched):
        return searched(motions, 1, lambda *of: True, lambda one: asked.append(one))

    monkeypatch.setattr(stepwise, "with_rest", second)
    monkeypatch.setattr(stepwise, "leave_out_sticks", lambda search: False)
    diagnose(small_arm(), blank(), [motion])
    assert len(asked) == 1


def test_whether_rest_asks_for_more_is_asked_of_what_was_searched_already(
    monkeypatch, motion, found
):
    """Of joints that never rest nothing changes; to search all laws anew took a tenth of the whole time."""
    asked, every = [], [replace(motion, held=np.zeros((len(found.regression.t), 2), bool))]
    monkeypatch.setattr(of_some_joints, "score_terms", lambda lin, *of: asked.append(lin) or [])
    search = search_of(found)
    assert not with_rest._asks_for_more(search, every, np.ones(2, bool))
    assert [lin.memory for lin in asked] == [search.memory]
    assert asked[0].found.motions[0].held is every[0].held
