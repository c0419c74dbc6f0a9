"""Before a formula is searched, what may stand in for it on the joint is taken away: laws, and a wide sign."""

from dataclasses import replace

import pytest
from planted import declared_fit, log_with

from jaxswarm.diagnose.discovery.stand_ins import bared
from jaxswarm.diagnose.selection.diagnosis import Diagnosis


def outcome(width: tuple[float, float]) -> Diagnosis:
    found, crossfit = declared_fit(log_with())
    found = replace(found, model=replace(found.model, width=width))
    return Diagnosis(found, found, (), (), crossfit, 50)


def test_a_sign_as_wide_as_the_others_stands_in_for_nothing():
    assert bared(outcome((0.01, 0.02)), 1) is None


def test_a_far_wider_sign_is_searched_as_wide_as_the_others():
    bare = bared(outcome((0.01, 0.12)), 1)
    assert bare.final.model.width == pytest.approx((0.01, 0.01))
    assert {t.identity for t in bare.final.model.terms} == {
        t.identity for t in outcome((0.01, 0.12)).final.model.terms
    }
