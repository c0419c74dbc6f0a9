"""Where friction may hold a joint for moments, a law has to show in its motion."""

from dataclasses import replace

import numpy as np
import pytest
from planted import blank, log_with
from test_told_at_rest import left, searched

from jaxswarm.diagnose.selection import laws_at_rest
from jaxswarm.effects.term import Term

ONE_WAY = Term("asymmetric_friction", 0)
WORM = Term("torque_offset", 0, values={"tau0": 2.0})


def asked(monkeypatch, search, held):
    """Whether rows were left out, friction being able to hold some joints or none."""
    monkeypatch.setattr(laws_at_rest, "is_held", lambda before, after: np.array(held))
    return laws_at_rest.leave_out_instead_of_laws(search)


def stuck(*hidden):
    """A log whose first joint is held at two newton meters less where it hardly moves."""
    log = log_with(*hidden)
    dq = np.gradient(log.q[:, 0], log.t)
    slow = np.abs(dq) < 0.01 * np.abs(dq).max()
    return replace(log, tau=log.tau - 2.0 * slow[:, None] * np.array([1.0, 0.0]))


def test_a_law_that_motion_does_not_need_goes_with_the_rows_that_told_it(monkeypatch):
    search = searched(blank(), ONE_WAY, log=stuck())
    before = search.current.regression.used_rows.mean(axis=0)
    assert asked(monkeypatch, search, [True, False])
    assert left(search) == [] and search.sticking == {0} and not search.banned
    after = search.current.regression.used_rows.mean(axis=0)
    assert after[0] < before[0] and after[1] == before[1]
    np.testing.assert_array_equal(search.declared.regression.used_rows.mean(axis=0), after)
    assert not asked(monkeypatch, search, [True, False])  # once


@pytest.mark.parametrize(
    ("hidden", "added", "held"),
    [
        ((WORM,), ONE_WAY, True),  # motion needs it
        ((), ONE_WAY, False),  # nothing holds the joint
        ((), Term("hysteresis", 0), True),  # a bristle shows where it turns
        ((), Term("stribeck_friction", 0), True),  # it fades with speed
    ],
)
def test_what_motion_needs_what_nothing_holds_and_what_rest_alone_shows_stays(
    monkeypatch, hidden, added, held
):
    search = searched(blank(), added, log=stuck(*hidden))
    assert not asked(monkeypatch, search, [held, False])
    assert left(search) == [added.effect] and not search.sticking


def test_a_law_that_explains_rest_as_well_as_motion_is_not_asked(monkeypatch):
    search = searched(blank(), ONE_WAY)
    assert not asked(monkeypatch, search, [True, False])
