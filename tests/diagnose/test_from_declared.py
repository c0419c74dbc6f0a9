"""The final model is not left with worse widths and clocks than the declared one has."""

import threading
from functools import partial

import numpy as np
import pytest
from planted import BAND, blank, log_with, search_of, small_arm

from jaxswarm.diagnose.selection import from_declared
from jaxswarm.diagnose.selection.from_declared import fit_from_declared
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.estimation.clock_skew import estimate_with_clocks
from jaxswarm.logs.motion import prepare
from jaxswarm.logs.shifted import shift_motion

SPRING = Term("joint_spring", 0, values={"k": 8.0, "tau0": 0.0})
WITH_SPRING = (*blank(), Term("joint_spring", 0))


@pytest.fixture(scope="module")
def motion():
    return prepare(log_with(SPRING), BAND)


def test_a_fit_that_is_stuck_begins_where_the_declared_model_stands(motion):
    best = estimate(small_arm(), WITH_SPRING, [motion], bounded=False)
    early = shift_motion(motion, -2e-3)
    width = tuple(np.multiply(8.0, best.model.width))
    stuck = estimate(small_arm(), WITH_SPRING, [early], width=width, bounded=False)
    search = search_of(stuck)
    fit_from_declared(search, partial(estimate_with_clocks, small_arm(), blank(), [motion]))
    sigma = best.fit.sigma
    cost = [((one.fit.residual / sigma) ** 2).sum() for one in (best, search.current, stuck)]
    assert cost[1] < 1.01 * cost[0] < 0.9 * cost[2]
    np.testing.assert_allclose(search.current.model.width, best.model.width, rtol=0.1)
    assert search.current.motions[0].skew == pytest.approx(0.0, abs=2e-4)
    assert [t.identity for t in search.current.model.terms] == [t.identity for t in WITH_SPRING]


def test_a_fit_in_the_same_valley_stays(motion):
    found = estimate(small_arm(), WITH_SPRING, [motion], bounded=False)
    search = search_of(found)
    fit_from_declared(search, partial(estimate_with_clocks, small_arm(), blank(), [motion]))
    assert search.current is found


def test_a_delay_that_was_added_says_when_torques_are_read(motion):
    terms = (*WITH_SPRING, Term("time_delay"))
    width = (0.5, 0.5)
    found = estimate(small_arm(), terms, [motion], width=width, bounded=False)
    search = search_of(found)
    fit_from_declared(search, partial(estimate_with_clocks, small_arm(), blank(), [motion]))
    assert search.current is found


@pytest.mark.parametrize("kept", [True, False])
def test_the_declared_model_is_fitted_beside_the_selection_unless_the_log_is_long(
    motion, kept, monkeypatch
):
    begun = threading.Event()

    def fitted(robot, declared, motions):
        begun.set()
        return estimate_with_clocks(robot, declared, motions)

    monkeypatch.setattr(from_declared, "estimate_with_clocks", fitted)
    monkeypatch.setattr(from_declared, "is_kept", lambda motion: kept)
    monkeypatch.setattr(from_declared.cores, "count", lambda: 2)
    with from_declared.declared_alone(small_arm(), blank(), [motion]) as alone:
        assert begun.wait(10.0 if kept else 0.05) == kept
        found = alone()
    expected = estimate_with_clocks(small_arm(), blank(), [motion])
    np.testing.assert_array_equal(found.fit.residual, expected.fit.residual)
