"""What moments in which friction holds a joint had told of it goes, unless its motion needs it."""

from types import SimpleNamespace

import pytest
from planted import BAND, blank, log_with, search_of, small_arm

from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.diagnose.selection.step import Step
from jaxswarm.diagnose.selection.told_at_rest import take_back_told_at_rest
from jaxswarm.effects.alike import has
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

COUPLING = Term("transmission_coupling", 0, 1)
SPRING = Term("joint_spring", 0, values={"k": 8.0, "tau0": 0.0})


def searched(declared, *added, hidden=(), log=None):
    """A selection on a log of two joints, with what it has added."""
    motion = prepare(log or log_with(*hidden), BAND)
    now = with_motion_noise(estimate(small_arm(), declared, [motion], bounded=False))
    search, steps = search_of(now), []
    for term in added:
        gone = tuple(t for t in now.model.terms if t.effect in term.law.contains and t.joint == 0)
        kept = tuple(t for t in now.model.terms if t not in gone)
        after = with_motion_noise(refit(now, (*kept, term)))
        score = SimpleNamespace(joint=0)
        steps.append(Step(after.model.terms[-1], score, (), (), now, after, gone))
        now = after
    search.steps, search.current = steps, now
    return search


def left(search):
    return [s.added.effect for s in search.steps]


def test_laws_that_friction_leaves_nothing_to_go():
    search = searched(blank(), Term("asymmetric_friction", 0), COUPLING)
    take_back_told_at_rest(search, {0})
    assert left(search) == []
    assert {t.effect for t in search.current.model.terms if t.joint == 0} == {
        "viscous_friction",
        "coulomb_friction",
    }


def test_what_stood_in_the_place_of_friction_goes_though_that_has_to_be_asked_again():
    """A coupling had the dry friction of its joint, which nobody needed beside it."""
    without = tuple(t for t in blank() if (t.effect, t.joint) != ("coulomb_friction", 0))
    search = searched(without, COUPLING)
    take_back_told_at_rest(search, {0})
    assert left(search) == []
    assert not has(Term("coulomb_friction", 0), search.current.model.terms)


@pytest.mark.parametrize(("hidden", "kept"), [((SPRING,), ["joint_spring"]), ((), [])])
def test_a_law_that_motion_needs_stays_with_all_of_its_joint(hidden, kept):
    search = searched(blank(), Term("joint_spring", 0), hidden=hidden)
    take_back_told_at_rest(search, {0})
    assert left(search) == kept


def test_laws_of_other_joints_and_everyday_ones_stay():
    without = tuple(t for t in blank() if (t.effect, t.joint) != ("viscous_friction", 0))
    search = searched(without, Term("viscous_friction", 0), Term("joint_spring", 1))
    take_back_told_at_rest(search, {0})
    assert left(search) == ["viscous_friction", "joint_spring"]
