"""Where friction may hold a joint for moments, the law of a partner has to show in its motion."""

import numpy as np
import pytest
from planted import blank
from test_told_at_rest import COUPLING, left, searched

from jaxswarm.diagnose.selection import pairs_at_rest
from jaxswarm.effects.term import Term

HIDDEN = Term("transmission_coupling", 0, 1, values={"b": 2.0, "fc": 0.0, "ia": 0.0})


def asked(monkeypatch, search, held):
    """Whether rows were left out, friction being able to hold some joints or none."""
    monkeypatch.setattr(pairs_at_rest, "is_held", lambda before, after: np.array(held))
    return pairs_at_rest.leave_out_instead_of_pairs(search)


def test_a_coupling_that_motion_does_not_need_goes_with_the_rows_that_told_it(monkeypatch):
    search = searched(blank(), COUPLING)
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
        ((HIDDEN,), COUPLING, True),
        ((), COUPLING, False),
        ((), Term("joint_spring", 0), True),
        ((), Term("cable_coupling", 0, 1), True),
    ],
)
def test_what_motion_needs_what_nothing_holds_and_other_laws_stay(monkeypatch, hidden, added, held):
    search = searched(blank(), added, hidden=hidden)
    assert not asked(monkeypatch, search, [held, False])
    assert left(search) == [added.effect] and not search.sticking
