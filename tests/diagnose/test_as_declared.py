"""Joints whose own torque is no better by another width of the sign keep the declared model's."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, blank, log_with, small_arm

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.decision.rules import SAVED, Rules
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.as_declared import _kept, keep_declared_widths
from jaxswarm.diagnose.selection.budget import Budget
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

SPRING = Term("joint_spring", 0, values={"k": 8.0, "tau0": 0.0})
WITH_SPRING = (*blank(), Term("joint_spring", 0))


@pytest.fixture(scope="module")
def motion():
    return prepare(log_with(SPRING), BAND)


@pytest.fixture(scope="module")
def declared(motion):
    return estimate(small_arm(), blank(), [motion], bounded=False)


@pytest.fixture(scope="module")
def best(motion):
    return estimate(small_arm(), WITH_SPRING, [motion], bounded=False)


def fitted_at(motion, width):
    return estimate(
        small_arm(), WITH_SPRING, [motion], width=tuple(width), refine_width=False, bounded=False
    )


def kept(current, declared, width) -> Search:
    search = Search(current, declared, Rules(), 0, Memory(), (), lambda text: None, Budget())
    search.crossfit = cross_fit(current)
    told = replace(declared, model=replace(declared.model, width=tuple(width)))
    keep_declared_widths(search, lambda: told)
    return search


def test_a_joint_keeps_the_declared_width_where_its_own_torque_is_no_better_by_another(
    motion, declared, best
):
    one, two = best.model.width
    current = fitted_at(motion, (one, 4.0 * two))
    found = kept(current, declared, (4.0 * one, two)).current
    np.testing.assert_allclose(found.model.width, (one, two))
    assert (found.fit.residual**2).sum() < (current.fit.residual**2).sum()
    assert [t.identity for t in found.model.terms] == [t.identity for t in WITH_SPRING]


def test_widths_that_are_better_on_every_joint_stay(motion, declared, best):
    current = fitted_at(motion, best.model.width)
    found = kept(current, declared, np.multiply(4.0, best.model.width)).current
    assert found is current


def test_what_depends_on_a_width_that_is_kept_is_as_uncertain_as_the_width(motion, declared, best):
    current = fitted_at(motion, (best.model.width[0], 4.0 * best.model.width[1]))
    found = kept(current, declared, best.model.width).current
    known = fitted_at(motion, found.model.width)
    doubt, least = (e.std_errors[3]["fc"] for e in (found, known))
    assert doubt > 1.05 * least


def test_a_joint_on_which_nothing_was_added_keeps_a_width_that_its_torque_does_not_tell_from_the_new(
    motion, declared, best
):
    one, two = np.multiply(best.model.width, (1.0, 1.01))
    current = fitted_at(motion, (one, two))
    found = kept(current, declared, (4.0 * one, 1.04 * two)).current
    np.testing.assert_allclose(found.model.width, (one, 1.04 * two))
    more = (found.fit.residual[:, 1] ** 2).sum() / (current.fit.residual[:, 1] ** 2).sum()
    assert 1.0 < more < 1.0 + SAVED * 2 / cross_fit(current).effective


def test_a_joint_on_which_something_was_added_takes_the_width_that_fits_best(
    motion, declared, best
):
    one, two = np.multiply(best.model.width, (1.0, 1.01))
    current = fitted_at(motion, (one, two))
    assert kept(current, declared, (1.04 * one, two)).current is current


def test_a_width_that_is_shared_is_told_by_all_who_share_it():
    acted, shared = np.array([True, False, False]), [(0, 1, 2)]

    def still(more, parts=shared):
        return _kept(parts, np.arange(3), np.array(more), acted, 4.0).tolist()

    assert still([38.0, -2.9, 3.0]) == []
    assert still([5.6, -3.1, 1.0]) == [1, 2]
    assert still([-1.0, -3.1, 1.0]) == [0, 1, 2]
    assert still([38.0, -2.9, 5.0], [(0,), (1,), (2,)]) == [1]
