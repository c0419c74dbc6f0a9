"""Before a formula is searched, what may stand in for it on the joint is taken away: laws, and a wide sign."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from planted import declared_fit, log_with

from jaxswarm.diagnose.discovery import proof
from jaxswarm.diagnose.discovery.proof import stays_near
from jaxswarm.diagnose.discovery.stand_ins import Discovery, bared, without_stand_ins
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.diagnose.selection.step import Step, find_term
from jaxswarm.effects.alike import without
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate


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


def tilted() -> Diagnosis:
    """A diagnosis that told a clean log as a tilt of the base."""
    plain = outcome((0.01, 0.01))
    tilt = Term("base_tilt", None, values={"gx": 0.0, "gy": 0.0})
    model = plain.final.model
    final = estimate(
        model.robot, (*model.terms, tilt), plain.final.motions, width=0.01, bounded=False
    )
    step = Step(final.model.terms[-1], None, (), (), plain.final, final, ())
    return replace(plain, final=final, steps=(step,))


def test_a_law_of_the_whole_arm_may_stand_in_for_what_pulls_on_two_joints():
    told = tilted()
    assert bared(told, 1) is None
    bare = bared(told, 1, whole_arm=True)
    assert [t.effect for t in bare.withdrawn] == ["base_tilt"] and not bare.kept
    assert "base_tilt" not in {t.effect for t in bare.final.model.terms}
    assert bared(outcome((0.01, 0.02)), 1, whole_arm=True) is None


def uneven() -> Diagnosis:
    """A diagnosis that told the Coulomb friction of a clean log as one that differs by direction."""
    plain = outcome((0.01, 0.01))
    model = plain.final.model
    level = next(t for t in model.terms if (t.effect, t.joint) == ("coulomb_friction", 1))
    law = Term("asymmetric_friction", 1, values={})
    final = refit(plain.final, (*without(level, model.terms), law))
    step = Step(
        find_term(final, law), SimpleNamespace(joint=1), (), (), plain.final, final, (level,)
    )
    return replace(plain, final=final, steps=(step,))


def test_a_law_in_place_of_a_declared_one_is_taken_away_and_that_one_comes_back():
    told = uneven()
    law = told.final.model.terms[0]
    found = Discovery(law, None, None, (), (), 0, (), told.declared, told.final)
    beside, _ = without_stand_ins(told, found, 0)
    for one in (beside, bared(told, 1)):
        assert [t.effect for t in one.withdrawn] == ["asymmetric_friction"] and not one.kept
        assert {t.identity for t in one.final.model.terms} == {
            t.identity for t in told.declared.model.terms
        }


@pytest.mark.parametrize(
    ("before", "after", "right"),
    [
        ((9.0, 1.2), (1.1, 1.3), True),
        ((9.0, 1.2), (1.1, 4.0), False),
        ((9.0, 5.0), (1.1, 6.0), True),
    ],
)
def test_no_joint_that_was_explained_is_given_up_for_a_formula(monkeypatch, before, after, right):
    def told(fit):
        return [SimpleNamespace(near=x < 2.0) for x in fit]

    monkeypatch.setattr(proof, "remainders", told)
    assert stays_near(before, after) is right


def test_what_was_added_anywhere_is_asked_again_beside_a_found_law():
    told = tilted()
    law = told.final.model.terms[0]
    found = Discovery(law, None, None, (), (), 0, (), told.declared, told.final)
    after, kept = without_stand_ins(told, found, 0)
    assert [t.effect for t in after.withdrawn] == ["base_tilt"] and not after.kept
    assert kept.added.identity == law.identity and kept.after is after.final
    assert "base_tilt" not in {t.effect for t in after.final.model.terms}
