"""Choices made while effects were missing are made again once all are in place."""

from dataclasses import replace

import pytest
from planted import added, declared_fit, diagnose_log, log_with

from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.competing import overlap, with_soft_joints
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.worth import passes
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection import reselect as reconsider_module
from jaxswarm.diagnose.selection.instead import far_less, leaves_less
from jaxswarm.diagnose.selection.pair import pair
from jaxswarm.diagnose.selection.refit import refit, refit_with
from jaxswarm.diagnose.selection.reselect import choose_again, reconsider
from jaxswarm.diagnose.selection.step import Step, competitors, find_term, near_ones
from jaxswarm.effects.term import Term

DRAG = Term("quadratic_drag", 1, values={"c": 1.5})


@pytest.fixture(scope="module")
def case():
    before, crossfit = declared_fit(log_with(DRAG))
    scores = score_terms(
        Linearization(before, crossfit), eligible_terms(before.model, before.motions), 0
    )
    return before, {s.candidate.term.identity: s for s in scores}


def step_of(case, effect, others) -> Step:
    """As if another law had been chosen."""
    before, scores = case
    score = scores[effect, 1, None, None]
    after = refit_with(before, score)
    added = next(t for t in after.model.terms if t.effect == effect)
    near = tuple(scores[o, 1, None, None] for o in others)
    return Step(added, score, (), near, before, after, (), near)


def test_a_law_that_stood_in_for_a_simpler_one_is_exchanged(case):
    step = step_of(case, "nonlinear_viscous_friction", ["quadratic_drag"])
    assert [t.effect for t in competitors(step)] == ["quadratic_drag"]
    steps, found, changed = reconsider([step], step.after, 60, Rules())
    assert changed and [s.added.effect for s in steps] == ["quadratic_drag"]
    assert steps[0].added.values["c"] == pytest.approx(1.5, rel=0.05)
    assert steps[0].added.identity in {t.identity for t in found.model.terms}
    assert "nonlinear_viscous_friction" not in {t.effect for t in found.model.terms}
    assert steps[0].before is case[0]
    assert "quadratic_drag" in {t.effect for t in steps[0].after.model.terms}


def test_competitors_say_the_same_on_the_same_joint(case):
    before, scores = case
    crossfit = cross_fit(before)
    chosen = scores["nonlinear_viscous_friction", 1, None, None]
    near = near_ones(chosen, list(scores.values()), crossfit)
    assert "quadratic_drag" in {s.candidate.term.effect for s in near}
    assert chosen not in near and {s.joint for s in near} == {1}
    for one in near:
        assert overlap(chosen.candidate, one.candidate, crossfit) > 0.7


@pytest.mark.parametrize(("part", "joint"), [(0.75, 1), (0.4, 1), (0.75, 0)])
def test_a_gear_competes_with_the_error_of_its_own_encoder(case, part, joint):
    """Judged by all joints both: a stiffening gear, told as an encoder's error, was not even asked again."""
    before, scores = case
    misread = scores["encoder_eccentricity", 1, None, None]
    soft = scores["joint_elasticity", joint, None, None]
    misread = replace(misread, gain=100.0)
    soft = replace(soft, on_all=replace(soft.on_all, gain=100.0 * part))
    competing = part > 0.6 and joint == 1
    found = with_soft_joints([misread], [misread, soft], lambda s: True)
    assert (soft.on_all in found[1:]) == competing
    near = near_ones(misread, [misread, soft.on_all], cross_fit(before))
    assert ("joint_elasticity" in {s.candidate.term.effect for s in near}) == competing
    assert with_soft_joints([misread], [misread, soft], lambda s: s is misread) == [misread]


def test_what_other_joints_lose_is_no_matter_of_a_law_on_its_own(case):
    """They share parameters with it, which half a short log knows badly."""
    drag = case[1]["quadratic_drag", 1, None, None]
    assert passes(drag, 60, Rules())
    assert passes(replace(drag, gain=-1.0), 60, Rules())
    assert not passes(replace(drag, gain=-1.0, own=None), 60, Rules())


def test_of_each_law_one_competes(case):
    """However many joints it may come from: the law that all of them contain needs a place."""
    before, scores = case
    chosen = scores["nonlinear_viscous_friction", 1, None, None]
    drag = scores["quadratic_drag", 1, None, None]
    many = [replace(drag, gain=drag.gain * (1.0 + 0.001 * k)) for k in range(5)]
    near = near_ones(chosen, many, cross_fit(before))
    assert [s.candidate.term.effect for s in near].count("quadratic_drag") == 1
    assert near[0] is many[-1]


def test_a_lone_effect_is_asked_again_if_a_simpler_one_came_near(case):
    lone = step_of(case, "nonlinear_viscous_friction", ["quadratic_drag"])
    crossfit = cross_fit(lone.after)
    steps, found, changed = choose_again([lone], lone.after, crossfit, 60, Rules())
    assert changed and [s.added.effect for s in steps] == ["quadratic_drag"]
    assert "quadratic_drag" in {t.effect for t in found.model.terms}


@pytest.mark.parametrize(
    ("alpha", "kept"), [(2.0, "quadratic_drag"), (1.6, "nonlinear_viscous_friction")]
)
def test_a_simpler_law_is_taken_if_it_does_as_well(monkeypatch, alpha, kept):
    """Even where the law with a free exponent was ahead while the others were not fitted with it."""
    hidden = Term("nonlinear_viscous_friction", 1, values={"c": 1.5, "alpha": alpha})
    before, crossfit = declared_fit(log_with(hidden))
    scores = score_terms(
        Linearization(before, crossfit), eligible_terms(before.model, before.motions), 0
    )
    there = before, {s.candidate.term.identity: s for s in scores}
    step = step_of(there, "nonlinear_viscous_friction", ["quadratic_drag"])

    def ahead(passed, rules, crossfit):
        assert "quadratic_drag" in {s.candidate.term.effect for s in passed}
        return next(s for s in passed if s.candidate.term.effect == step.added.effect), []

    monkeypatch.setattr(reconsider_module, "choose", ahead)
    steps, found, changed = reconsider([step], step.after, 60, Rules())
    assert [s.added.effect for s in steps] == [kept]
    assert changed == (kept == "quadratic_drag")
    assert kept in {t.effect for t in found.model.terms}


@pytest.mark.parametrize("kept", ["joint_spring", "cubic_spring"])
def test_of_two_laws_of_as_many_numbers_the_one_that_does_not_bend_is_taken_if_it_does_as_well(
    monkeypatch, kept
):
    values = {"joint_spring": {"k": 8.0, "tau0": 2.0}, "cubic_spring": {"k3": 30.0, "q0": 0.1}}
    before, crossfit = declared_fit(log_with(Term(kept, 1, values=values[kept])))
    scores = score_terms(
        Linearization(before, crossfit), eligible_terms(before.model, before.motions), 0
    )
    there = before, {s.candidate.term.identity: s for s in scores}
    step = step_of(there, "cubic_spring", ["joint_spring"])
    monkeypatch.setattr(
        reconsider_module, "choose", lambda passed, rules, crossfit: (passed[0], [])
    )
    steps, found, changed = reconsider([step], step.after, 60, Rules())
    assert [s.added.effect for s in steps] == [kept]
    assert changed == (kept == "joint_spring")


def test_the_right_law_stays_and_nothing_is_fitted_anew(case):
    step = step_of(case, "quadratic_drag", ["nonlinear_viscous_friction"])
    steps, found, changed = reconsider([step], step.after, 60, Rules())
    assert not changed and found is step.after
    assert steps[0].added == step.added


def test_what_nobody_needs_is_dropped(case):
    right = step_of(case, "quadratic_drag", [])
    score = case[1]["torque_offset", 1, None, None]
    spare = Term("torque_offset", 1)
    both = refit(right.after, (*right.after.model.terms, spare))
    near = replace(
        case[1]["joint_spring", 1, None, None], gain=2.0 * abs(score.gain), joint=score.joint
    )
    later = Step(spare, score, (), (near,), right.after, both, (), (near,))
    steps, found, changed = reconsider([right, later], both, 60, Rules())
    assert changed and [s.added.effect for s in steps] == ["quadratic_drag"]
    assert "torque_offset" not in {t.effect for t in found.model.terms}


def test_what_stood_beside_a_law_that_is_gone_gives_way_to_a_plainer_one(case):
    """Nobody had asked for the drag itself: two laws shared what it does."""
    bent = step_of(case, "nonlinear_viscous_friction", [])
    spare = Term("torque_offset", 1)
    both = refit(bent.after, (*bent.after.model.terms, spare))
    near = replace(case[1]["joint_spring", 1, None, None], joint=1)
    later = Step(
        spare, case[1]["torque_offset", 1, None, None], (), (near,), bent.after, both, (), (near,)
    )
    steps, found, changed = reconsider([bent, later], both, 60, Rules())
    assert changed and [s.added.effect for s in steps] == ["quadratic_drag"]
    assert steps[0].added.values["c"] == pytest.approx(1.5, rel=0.05)
    assert {t.effect for t in found.model.terms if t.joint == 1} >= {"quadratic_drag"}
    # Another law has taken the place of one that was added before: it is asked no more.
    gone = replace(bent, added=Term("hysteresis", 1, values={"fc": 1.0, "x0": 0.05}))
    instead = replace(bent, removed=(gone.added,))
    steps, _, _ = reconsider([gone, instead, later], both, 60, Rules())
    assert [s.added.effect for s in steps] == ["hysteresis", "quadratic_drag"]
    alone, _, again = reconsider([bent], bent.after, 60, Rules())
    assert not again and [s.added.effect for s in alone] == ["nonlinear_viscous_friction"]


@pytest.mark.parametrize("certain", [True, False])
def test_everyday_friction_stays_only_if_it_is_certain(case, monkeypatch, certain):
    """It came with that of other joints; where it fails a test of its own, its value has to be sure."""
    step = step_of(case, "quadratic_drag", [])
    friction = Term("viscous_friction", 1)
    score = replace(case[1]["torque_offset", 1, None, None], share=0.3)
    there = refit(step.after, step.after.model.terms)
    added = next(t for t in there.model.terms if t.identity == friction.identity)
    doubted = Step(added, score, (), (), there, there, (), ())
    monkeypatch.setattr(reconsider_module, "is_certain", lambda term, errors: certain)
    monkeypatch.setattr(reconsider_module, "passes", lambda *a: False)
    monkeypatch.setattr(reconsider_module, "score_terms", lambda *a: [score])
    near = replace(score, candidate=replace(score.candidate, term=Term("torque_offset", 1)))
    steps, found, changed = reconsider([replace(doubted, near=(near,))], there, 60, Rules())
    assert changed != certain and len(steps) == int(certain)
    assert (friction.identity in {t.identity for t in found.model.terms}) == certain


def test_a_law_bent_into_the_sum_of_two_is_told_as_two():
    """A Stribeck law with free exponent follows most of a wide one plus drag."""
    hidden = Term("stribeck_friction", 1, values={"df": 3.0, "vs": 0.12, "delta": 2.0}), DRAG
    found = diagnose_log(log_with(*hidden))
    assert {t[0] for t in added(found)} == {"stribeck_friction", "quadratic_drag"}
    values = {k: v for t in found.final.model.terms for k, v in t.values.items() if t.joint == 1}
    assert values["vs"] == pytest.approx(0.12, rel=0.15)
    assert values["c"] == pytest.approx(1.5, rel=0.15)
    gone = {t.effect for t in found.withdrawn}
    assert gone.isdisjoint({s.added.effect for s in found.steps})


def test_a_pair_is_refused_where_one_law_says_it_all(case):
    step = step_of(case, "nonlinear_viscous_friction", ["quadratic_drag"])
    assert pair([step], step.after, [1], 60, Rules()) is None


@pytest.mark.parametrize(("partner", "named"), [(0.0, None), (2.0, "cable_coupling")])
def test_a_law_of_more_numbers_is_taken_where_it_leaves_less_once_all_is_fitted(partner, named):
    """Both were near each other when they were chosen between; only one knows of the other joint."""
    hidden = Term("cable_coupling", 1, other=0, values={"kc": partner, "k": 4.0, "tau0": -2.4})
    before, crossfit = declared_fit(log_with(hidden))
    asked = [Term("joint_spring", 1), Term("cable_coupling", 1, other=0)]
    scores = score_terms(Linearization(before, crossfit), asked, 0)
    spring, cable = (next(s for s in scores if s.candidate.term.effect == t.effect) for t in asked)
    current = refit_with(before, spring)
    found = leaves_less(spring, [cable], before, current, (), True)
    assert (found and found[0].candidate.term.effect) == named
    assert leaves_less(spring, [cable], before, current, (), False) is None


def two_springs(hidden, k3):
    """Of a log with one of two springs: the declared fit, what either is worth, the fit with a straight one."""
    values = {"joint_spring": {"k": 8.0, "tau0": 2.0}, "cubic_spring": {"k3": k3, "q0": 0.1}}
    before, crossfit = declared_fit(log_with(Term(hidden, 1, values=values[hidden])))
    asked = [Term("joint_spring", 1), Term("cubic_spring", 1)]
    scores = score_terms(Linearization(before, crossfit), asked, 0)
    spring, cubic = (next(s for s in scores if s.candidate.term.effect == t.effect) for t in asked)
    return before, spring, cubic, refit(before, (*before.model.terms, asked[0]))


@pytest.mark.parametrize(
    ("hidden", "named"), [("joint_spring", None), ("cubic_spring", "cubic_spring")]
)
def test_of_two_laws_of_as_many_numbers_the_one_that_leaves_less_is_taken_near_the_noise_too(
    hidden, named
):
    before, spring, cubic, current = two_springs(hidden, 30.0)
    found = leaves_less(spring, [cubic], before, current, (), False)
    assert (found and found[0].candidate.term.effect) == named


@pytest.mark.parametrize(
    ("hidden", "named"), [("joint_spring", None), ("cubic_spring", "cubic_spring")]
)
def test_a_rival_that_leaves_far_less_once_fitted_is_taken_at_once(hidden, named):
    before, spring, cubic, after = two_springs(hidden, 60.0)
    taken, fit, others = far_less(spring, [cubic], after, before)
    assert taken is (spring if named is None else cubic) and (fit is after) == (named is None)
    assert others == [cubic if named is None else spring]
    assert far_less(spring, [], after, before) == (spring, after, [])


def test_a_law_that_holds_its_competitor_is_no_pair_with_it():
    """Asked beside the spring that it contains, a cable takes its place, and there are no two."""
    hidden = Term("cable_coupling", 1, other=0, values={"kc": 4.0, "k": 6.0, "tau0": -2.4})
    before, crossfit = declared_fit(log_with(hidden))
    asked = [Term("joint_spring", 1), Term("cable_coupling", 1, other=0)]
    scores = score_terms(Linearization(before, crossfit), asked, 0)
    spring, cable = (next(s for s in scores if s.candidate.term.effect == t.effect) for t in asked)
    after = refit_with(before, cable)
    added = find_term(after, cable.candidate.term)
    step = Step(added, cable, (), (spring,), before, after, (), (spring,))
    assert [t.effect for t in competitors(step)] == ["joint_spring"]
    assert pair([step], after, [1], 60, Rules()) is None
