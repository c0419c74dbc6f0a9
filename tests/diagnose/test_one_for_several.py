"""What a law of the whole arm explains is not told as laws of joints, though these are proven more easily."""

from dataclasses import replace

import pytest
from elbow import ask, elbow, elbow_log, fitted
from planted import BAND, NOISE

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.selection import one_for_several as module
from jaxswarm.diagnose.selection.budget import Budget
from jaxswarm.diagnose.selection.one_for_several import one_for_several
from jaxswarm.diagnose.selection.refit import refit, refit_with
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import Step, find_term
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import synthetic_log
from jaxswarm.logs.motion import prepare

BODY = {
    **{"m": 1.5, "mcx": 0.15, "mcy": 0.0, "mcz": 0.05},
    **{"Ixx": 0.01, "Ixy": 0.0, "Iyy": 0.02, "Ixz": 0.0, "Iyz": 0.0, "Izz": 0.02, "log": 0.0},
}
LOAD = Term("payload_change", values={**BODY, "start": 4.3, "end": 8.1})
SPRING = Term("joint_spring", 1, values={"k": 12.0, "tau0": 1.0})
DRAG = Term("quadratic_drag", 2, values={"c": 1.0})
POWER = Term("nonlinear_viscous_friction", 2)


def ended(truths, *joint_laws):
    """A search that has added laws of a joint, as if no other one had been proven."""
    return with_laws(fitted(elbow_log(*truths)), truths[0].joint, *joint_laws)


def with_laws(declared, joint, *joint_laws):
    """The same of a fit of the declared model."""
    found = with_motion_noise(declared, 0)
    search = Search(found, found, Rules(), 0, Memory(), (), lambda text: None, Budget())
    for law in joint_laws:
        before = search.current
        asked = [s for s in ask(before, law) if s.candidate.term.joint == joint or joint is None]
        score = max(asked, key=lambda s: s.share)
        search.current = refit(before, (*before.model.terms, score.candidate.term))
        added = find_term(search.current, score.candidate.term)
        search.steps.append(Step(added, score, (), (), before, search.current, ()))
    return search


@pytest.mark.parametrize("joint_law", ["torque_offset", "torque_ripple"])
def test_a_load_takes_the_place_of_what_was_told_of_a_joint(joint_law):
    search = ended([LOAD], joint_law)
    told = search.steps[0].added
    assert told.effect == joint_law
    assert one_for_several(search)
    (step,) = search.steps
    assert step.added.effect == "payload_change" and search.withdrawn == (told,)
    assert step.added.values["m"] == pytest.approx(1.5, rel=0.03)
    assert [t.effect for t in search.current.model.terms].count(joint_law) == 0
    assert not one_for_several(search)


def test_what_every_drive_has_stays():
    search = ended([LOAD], "torque_offset")
    (step,) = search.steps
    friction = replace(step, added=search.current.model.terms[0])
    assert friction.added.law.everyday
    search.steps = [friction]
    assert not one_for_several(search)
    search.steps = [friction, step]
    assert one_for_several(search)
    assert [s.added.effect for s in search.steps] == [friction.added.effect, "payload_change"]


@pytest.mark.parametrize("drag", [True, False])
def test_a_power_of_the_speed_takes_the_place_of_all_that_a_joint_was_told(drag):
    """It was told as viscous, dry and Stribeck friction; true viscous and dry friction beside a drag stay."""
    friction = parse_terms("viscous_friction,coulomb_friction", elbow().joints)
    others = tuple(t for t in friction if t.joint != 2)
    truths = [replace(t, values={"b": 2.0, "fc": 2.0}) for t in (friction if drag else others)]
    truths.append(DRAG if drag else replace(POWER, values={"c": 6.0, "alpha": 0.35}))
    log = synthetic_log(elbow(), truths, 1, noise=NOISE, duration=12.0, rate=125.0)
    declared = estimate(elbow(), others, [prepare(log, BAND)], bounded=False)
    last = DRAG.effect if drag else "stribeck_friction"
    search = with_laws(declared, 2, "viscous_friction", "coulomb_friction", last)
    assert one_for_several(search) is not drag
    if not drag:
        (step,) = search.steps
        assert step.added.place == POWER.place
        assert step.added.values["alpha"] == pytest.approx(0.35, abs=0.02)
        assert not [t for t in search.current.model.terms if t.joint == 2 and t.law.everyday]


def test_a_zero_that_is_off_takes_the_place_of_an_offset():
    search = ended([Term("encoder_offset", 1, values={"dq0": 0.2})], "torque_offset")
    assert one_for_several(search)
    (step,) = search.steps
    assert step.added.place == ("encoder_offset", 1, None)
    assert step.added.values["dq0"] == pytest.approx(0.2, abs=0.01)


@pytest.mark.parametrize("truth", [SPRING, DRAG], ids=lambda t: t.effect)
def test_a_law_of_a_joint_that_is_right_stays(truth):
    search = ended([truth], truth.effect)
    assert not one_for_several(search)
    assert search.steps[0].added.effect == truth.effect


def test_a_law_of_a_joint_that_is_wrong_stays_where_none_of_the_arm_explains_more():
    search = ended([SPRING], "torque_ripple")
    assert not one_for_several(search)
    assert search.steps[0].added.effect == "torque_ripple"


def test_a_law_takes_the_place_of_two_on_its_joint():
    """A drive gain was told as a saturation and a cable, each proven more easily."""
    search = ended([SPRING], "gravity_compensator", "quadratic_drag")
    assert one_for_several(search)
    (step,) = search.steps
    assert step.added.place == ("joint_spring", 1, None) and len(search.withdrawn) == 2
    assert step.added.values["k"] == pytest.approx(12.0, rel=0.02)


def test_two_laws_of_a_joint_that_are_right_stay():
    drag = Term("quadratic_drag", 1, values={"c": 1.0})
    search = ended([SPRING, drag], "joint_spring", "quadratic_drag")
    assert [s.added.joint for s in search.steps] == [1, 1]
    assert not one_for_several(search)


def test_a_law_that_leaves_far_more_to_first_order_is_not_fitted(monkeypatch):
    """On a measured arm 36 fits took a third of the whole time, and none did as well."""
    fits = []

    def counted(before, score):
        fits.append((score.candidate.term.effect, score.trained))
        return refit_with(before, score)

    monkeypatch.setattr(module, "refit_with", counted)
    drag = Term("quadratic_drag", 1, values={"c": 1.0})
    right = ended([SPRING, drag], "joint_spring", "quadratic_drag")
    assert not one_for_several(right)
    shares = [share for _, share in fits]
    few = len(fits)
    monkeypatch.setattr(module, "FAR_MORE", 1e9)
    assert not one_for_several(right)
    every = [share for _, share in fits[few:]]
    assert few < len(every) and set(shares) <= set(every)
    assert min(shares, default=1.0) > min(every)
