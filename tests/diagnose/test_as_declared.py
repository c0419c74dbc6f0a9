"""Joints whose own torque is no better by another width of the sign keep the declared model's."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, blank, log_with, small_arm

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.selection.as_declared import keep_declared_widths
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
