"""What explains a small part of what a joint lacks is no name for it; what explains the rest stays."""

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from planted import BAND, blank, log_with, small_arm

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.budget import Budget
from jaxswarm.diagnose.selection.refit import refit, refit_with
from jaxswarm.diagnose.selection.shadow import of_lost_joints
from jaxswarm.diagnose.selection.stand import that_may_stand
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import Step, competitors, find_term
from jaxswarm.diagnose.selection.take_back import (
    take_back,
    take_back_events,
    take_back_harm,
    take_back_idle,
    take_back_nothing,
    take_back_shadows,
    take_back_stand_ins,
)
from jaxswarm.diagnose.selection.tenable import is_certain
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import prepare

module = import_module("jaxswarm.diagnose.selection.take_back")
reasons = import_module("jaxswarm.diagnose.selection.may_not_stay")

OFFSET = Term("torque_offset", 1)
SPRING = Term("joint_spring", 1)
DRAG = Term("quadratic_drag", 1)
# Of a log of 12 s half does not tell the bodies well enough to see what is left of a friction law [s].
LONG = 30.0
LOAD = Term("load_dependent_friction", 1)
COUPLING = Term("transmission_coupling", 1, 0)
RIPPLE = Term("torque_ripple", 1)
BENT = Term("dead_zone_spring", 1)
CUBIC = Term("cubic_spring", 1, values={"k3": 1.0, "q0": 0.0})


def searched(unknown: float) -> Search:
    """As if an offset of 1.5 N m had been added, with a wave of no known law of so many N m beside it."""
    log = log_with(replace(OFFSET, values={"tau0": 1.5}))
    return told_as(OFFSET, log, unknown * np.sin(7.3 * log.t) * np.sin(3.1 * log.t**1.5))


def told_as(term: Term, log: Log, extra: np.ndarray) -> Search:
    """As if a term of joint 2 had been added to a log with a further torque (T,) there."""
    tau = log.tau.copy()
    tau[:, 1] += extra
    motion = prepare(replace(log, tau=tau), BAND)
    before = with_motion_noise(estimate(small_arm(), blank(), [motion], bounded=False))
    search = Search(before, before, Rules(), 0, Memory(), (), lambda text: None, Budget())
    search.crossfit = cross_fit(before)
    add(search, term)
    return search


def add(search: Search, term: Term) -> None:
    """As if a term had been added to what a search has."""
    before = search.current
    (score,) = score_terms(Linearization(before, search.folds), [term], 0)
    search.current = with_motion_noise(refit_with(before, score))
    added = find_term(search.current, score.candidate.term)
    search.steps.append(Step(added, score, (), (), before, search.current, ()))
    search.crossfit = cross_fit(search.current)


def test_what_explains_all_that_is_missing_stays():
    search = searched(0.0)
    take_back_shadows(search)
    assert [s.added.effect for s in search.steps] == ["torque_offset"] and not search.refused


def test_a_small_part_of_what_is_missing_is_taken_back_and_told():
    search = searched(12.0)
    take_back_shadows(search)
    assert not search.steps
    assert OFFSET.identity not in {t.identity for t in search.current.model.terms}
    ((term, why),) = search.refused
    assert term.effect == "torque_offset"
    assert "squared error of joint2" in why and "times its noise" in why


def test_a_large_part_stays_though_more_is_missing():
    search = searched(0.6)
    left = search.current.fit.sigma[1] / search.crossfit.noise[1]
    assert 2.0 < left < 8.0
    take_back_shadows(search)
    assert [s.added.effect for s in search.steps] == ["torque_offset"]


def test_half_is_no_name_where_the_rest_is_very_far_above_the_noise():
    search = searched(2.0)
    left = search.current.fit.sigma[1] / search.crossfit.noise[1]
    before = search.declared.fit.sigma[1]
    assert left > 8.0 and search.current.fit.sigma[1] < 0.8 * before
    take_back_shadows(search)
    assert not search.steps


@pytest.mark.parametrize(("unknown", "lost"), [(2.0, True), (2.0, False), (0.0, True)])
def test_what_would_be_taken_back_again_is_not_added_again(unknown, lost):
    """Of a wrist that no law explained a dozen laws took a part each, one after the other: 20 minutes."""
    search = searched(unknown)
    take_back_shadows(search)
    assert search.lost == ({1} if unknown else set())
    search.current, search.crossfit = search.declared, cross_fit(search.declared)
    search.lost = {1} if lost else set()
    scores = score_terms(Linearization(search.declared, search.folds), [OFFSET], 0)
    told = of_lost_joints(search, scores)
    assert [s for s, _ in told] == (scores if unknown and lost else [])
    assert all("squared error of joint2, which stays" in why for _, why in told)


def test_nearly_all_is_one_whatever_is_left():
    log = log_with(replace(SPRING, values={"k": 60.0, "tau0": -6.0}))
    search = told_as(SPRING, log, 2.0 * np.sin(7.3 * log.t) * np.sin(3.1 * log.t**1.5))
    assert search.current.fit.sigma[1] / search.crossfit.noise[1] > 8.0
    take_back_shadows(search)
    assert [s.added.effect for s in search.steps] == ["joint_spring"]


WAVES = [Term("torque_ripple", 1, values={"sine": 9.0, "cosine": 0.0, "n": n}) for n in (7.0, 19.0)]


@pytest.mark.parametrize(("unknown", "stays"), [(2.0, True), (8.0, False)])
def test_orders_of_a_ripple_count_together_where_the_rest_is_very_far(unknown, stays):
    """Of a wrong wrist one order was told, at 18 times the noise: it had taken half."""
    log = log_with(*WAVES)
    search = told_as(RIPPLE, log, unknown * np.sin(7.3 * log.t) * np.sin(3.1 * log.t**1.5))
    add(search, RIPPLE)
    assert search.current.fit.sigma[1] / search.crossfit.noise[1] > 8.0
    take_back_shadows(search)
    assert len(search.steps) == 2 * stays


@pytest.mark.parametrize(("unknown", "stays"), [(0.0, True), (2.0, False)])
def test_a_force_of_its_own_period_that_takes_half_is_none_where_the_rest_is_very_far(
    unknown, stays
):
    """Beside a supply that sagged three of them were told, and the joints left at 10 to 30 times the noise."""
    force = Term("periodic_force", 1, values={"sine": 3.0, "cosine": 0.0, "hertz": 3.1, "log": 0.0})
    log = log_with(force)
    search = told_as(
        Term("periodic_force", 1), log, unknown * np.sin(7.3 * log.t) * np.sin(3.1 * log.t**1.5)
    )
    take_back_shadows(search)
    assert len(search.steps) == stays


@pytest.mark.parametrize(("elsewhere", "stays"), [(12.0, False), (0.6, True)])
def test_a_small_part_stays_where_another_log_shows_it(elsewhere, stays):
    """A spring took 0.13 off another log of an arm that swayed on its base, at 2.6 times the noise."""
    search = searched(12.0)
    log = log_with(replace(OFFSET, values={"tau0": 1.5}), motion_seed=11)
    tau = log.tau.copy()
    tau[:, 1] += elsewhere * np.sin(7.3 * log.t) * np.sin(3.1 * log.t**1.5)
    search.other = (prepare(replace(log, tau=tau), BAND),)
    take_back_shadows(search)
    assert bool(search.steps) == stays
    assert all("on other motion" in why for _, why in search.refused)


@pytest.mark.parametrize(("there", "stays"), [(60.0, True), (0.0, False)])
def test_a_law_that_raises_the_error_of_its_own_joint_elsewhere_is_taken_back(there, stays):
    """Of its own joint it need not be certain: friction at places was one by the position while rows stuck."""
    search = told_as(SPRING, log_with(replace(SPRING, values={"k": 60.0, "tau0": -6.0})), 0.0)
    spring = () if not there else (replace(SPRING, values={"k": there, "tau0": -6.0}),)
    search.other = (prepare(log_with(*spring, motion_seed=11), BAND),)
    found = reasons.raises_its_own(search)
    assert (found is None) == stays
    assert stays or "raises the error of joint2 on" in found[1]
    take_back_harm(search)
    assert bool(search.steps) == stays


@pytest.mark.parametrize("times", [1, 2])
def test_what_is_taken_back_twice_is_asked_no_more(times):
    """A spring and a lever on a spring took each other's place, and were taken back, for ever."""
    search = searched(12.0)
    steps, current = search.steps, search.current
    for _ in range(times):
        search.steps, search.current, search.crossfit = steps, current, cross_fit(current)
        take_back(search)
        assert not search.steps
    assert search.gone == {OFFSET.identity}
    assert search.barred == ({OFFSET.identity} if times > 1 else set())


@pytest.mark.parametrize("unknown", [0.0, 12.0])
def test_the_folds_are_those_of_the_model_that_is_left(unknown):
    search = searched(unknown)
    take_back_shadows(search)
    np.testing.assert_allclose(search.crossfit.noise, cross_fit(search.current).noise)


@pytest.mark.parametrize("there", [True, False])
def test_what_is_not_told_from_nothing_in_the_end_is_taken_back(there):
    """A dead band of -0.7 +- 0.7 N m stood in the headline, worth half of the error on the way there."""
    search = searched(0.0)
    if not there:
        terms = search.current.model.terms
        motion = prepare(log_with(), BAND)
        search.current = with_motion_noise(estimate(small_arm(), terms, [motion], bounded=False))
    take_back_idle(search)
    held = {t.identity for t in search.current.model.terms}
    assert (OFFSET.identity in held) is there
    assert [s.added.effect for s in search.steps] == ["torque_offset"] * there
    assert [why.startswith("is not told from nothing") for _, why in search.refused] == [True] * (
        not there
    )


def leaves_half(current, rest):
    return np.full(current.model.robot.num_joints, 0.5)


@pytest.mark.parametrize("shown", [True, False])
def test_what_no_number_tells_stays_only_where_another_log_shows_it(monkeypatch, shown):
    """A coupling of 0.01 +- 0.03 N m s/rad survived in held-out time of a log with slow noise."""
    search = searched(0.0)
    monkeypatch.setattr(reasons, "is_certain", lambda term, errors, least: False)
    monkeypatch.setattr(reasons, "share_left", leaves_half)
    monkeypatch.setattr(reasons, "survives", lambda *a: None)
    search.other = tuple(search.current.motions) * shown
    take_back_idle(search)
    assert [s.added.effect for s in search.steps] == ["torque_offset"] * shown
    assert ["--validation" in why for _, why in search.refused] == [True] * (not shown)


@pytest.mark.parametrize("shown", [True, False])
def test_what_is_hardly_told_from_nothing_stays_only_beside_another_log(monkeypatch, shown):
    """Noise with a memory of seconds was told as crosstalk of 0.008 +- 0.003, one of a hundred asked."""
    search = searched(0.0)
    added = search.steps[0].added
    hardly = (added, {"tau0": abs(added.values["tau0"]) / 2.5})
    assert is_certain(*hardly)
    monkeypatch.setattr(reasons, "share_left", leaves_half)
    monkeypatch.setattr(reasons, "with_errors", lambda term, current: hardly)
    monkeypatch.setattr(reasons, "survives", lambda *a: "not on this one")
    search.other = tuple(search.current.motions) * shown
    take_back_idle(search)
    assert [s.added.effect for s in search.steps] == ["torque_offset"] * shown


@pytest.mark.parametrize("left", [0.02, 0.5])
def test_what_takes_nearly_all_off_its_joint_is_told_from_nothing_by_that(monkeypatch, left):
    """A spring on a lever, confounded with weight, was 2.0 standard errors from none; a coupling took half."""
    search = searched(0.0)
    added = search.steps[0].added
    monkeypatch.setattr(reasons, "with_errors", lambda term, current: (added, {"tau0": 1e3}))
    monkeypatch.setattr(reasons, "share_left", lambda current, rest: np.full(3, left))
    search.other = ()
    take_back_idle(search)
    assert [s.added.effect for s in search.steps] == ["torque_offset"] * (left < 0.1)


@pytest.mark.parametrize("left", [0.3, 0.5])
def test_a_law_that_bends_need_not_take_as_much(monkeypatch, left):
    """Friction by the load of an upright axis was 2.5 standard errors from none, and took 0.90 off."""
    search = told_as(LOAD, log_with(replace(LOAD, values={"mu": 0.4, "inertial": 0.6})), 0.0)
    added = search.steps[0].added
    monkeypatch.setattr(reasons, "with_errors", lambda term, current: (added, {"mu": 1e3}))
    monkeypatch.setattr(reasons, "share_left", lambda current, rest: np.full(2, left))
    take_back_idle(search)
    assert [s.added.effect for s in search.steps] == [LOAD.effect] * (left < 0.35)


@pytest.mark.parametrize("part", [1.0, 0.1])
def test_a_spring_that_filters_the_noise_is_taken_back(monkeypatch, part):
    """``part``: of what it takes off its joint, without the noise of positions."""
    search = searched(0.0)
    monkeypatch.setattr(reasons, "is_spring", lambda term: True)
    monkeypatch.setattr(reasons, "over_noise", lambda found: np.full(2, 1.2))
    monkeypatch.setattr(reasons, "fall_without_noise", lambda *a: part)
    take_back(search)
    assert [s.added.effect for s in search.steps] == ["torque_offset"] * (part > 0.5)
    assert [why.startswith("filters the noise") for _, why in search.refused] == [True] * (
        part < 0.5
    )


@pytest.mark.parametrize("far", [True, False])
def test_a_joint_left_far_from_its_noise_may_lack_two_laws(monkeypatch, far):
    """Friction of each direction stood in for two, and was taken back when nobody asked for two any more."""
    search = searched(0.0)
    monkeypatch.setattr(module, "outdone", lambda search: (search.steps[0], "no better"))
    monkeypatch.setattr(module, "over_noise", lambda found: np.array([0.9, 6.0 if far else 1.9]))
    assert take_back(search) is far


@pytest.mark.parametrize("value", [0.0, 1.5])
def test_what_bounds_leave_nothing_of_is_taken_back(monkeypatch, value):
    """A drag of 0.0 +- 1.7 N m stood in the report of a measured arm."""
    search = searched(0.0)
    held = replace(search.steps[0].added, values={"tau0": value})
    monkeypatch.setattr(reasons, "find_term", lambda current, term: held)
    assert take_back_nothing(search) is (value == 0.0)
    assert [s.added.effect for s in search.steps] == ["torque_offset"] * (value != 0.0)


def _position(log, joint=1):
    return log.q[:, joint]


def _velocity(log, joint=1):
    return np.gradient(log.q[:, joint], log.t)


def _by_load(log):
    """What friction by the load adds to the same motion [N m]."""
    true = replace(LOAD, values={"mu": 0.1, "inertial": 0.0})
    return log_with(true, duration=LONG).tau[:, 1] - log.tau[:, 1]


OTHER_FORMS = [
    (SPRING, lambda log: 2.0 * np.exp(_position(log) / 0.4)),
    (DRAG, lambda log: 3.0 * _velocity(log) * np.sin(0.9 * np.abs(_velocity(log))) ** 4),
    (COUPLING, lambda log: 3.0 * np.sin(2.5 * _velocity(log, 0))),
    (LOAD, lambda log: 6.0 * _by_load(log) * np.abs(_by_load(log))),
]


@pytest.mark.parametrize(("term", "extra"), OTHER_FORMS, ids=lambda x: getattr(x, "effect", ""))
def test_what_leaves_a_function_of_its_own_variable_is_taken_back(term, extra):
    log = log_with(duration=LONG)
    search = told_as(term, log, extra(log))
    take_back_stand_ins(search)
    assert not search.steps
    ((refused, why),) = search.refused
    assert refused.effect == term.effect and "a law of another form" in why


@pytest.mark.parametrize(
    ("straight", "asked"),
    [(False, 100), (True, 100), (False, 10**60)],
    ids=["bent", "straight", "chance"],
)
def test_near_the_noise_a_bent_law_is_none_and_a_straight_one_stays(straight, asked):
    """Drag by the square of the partner's speed was told as a coupling, at 1.24 times the noise."""
    log = log_with(duration=LONG)
    v = _velocity(log, 0)
    search = told_as(COUPLING, log, 0.2 * v if straight else 0.1 * v * np.abs(v))
    search.asked = asked
    assert search.current.fit.sigma[1] < 2.0 * search.crossfit.noise[1]
    take_back_stand_ins(search)
    stays = straight or asked > 100
    assert [s.added.effect for s in search.steps] == ["transmission_coupling"] * stays
    assert len(search.refused) == (not stays)


TRUE_FORMS = [
    replace(SPRING, values={"k": 9.0, "tau0": -0.9}),
    replace(DRAG, values={"c": 3.0}),
    replace(LOAD, values={"mu": 0.1, "inertial": 0.0}),
]


@pytest.mark.parametrize("true", TRUE_FORMS, ids=lambda term: term.effect)
@pytest.mark.parametrize("unknown", [0.0, 1.0])
def test_a_law_of_its_form_stays_whatever_else_is_missing(true, unknown):
    log = log_with(true)
    other = unknown * np.sin(7.3 * log.t) * np.sin(3.1 * log.t**1.5)
    search = told_as(replace(true, values={}), log, other)
    take_back_stand_ins(search)
    assert [s.added.effect for s in search.steps] == [true.effect]


@pytest.mark.parametrize("orders", [1, 2])
def test_a_ripple_of_which_more_orders_were_found_may_have_others(orders):
    """One beside which no further order helps is none: a detent left 15 times the noise."""
    log = log_with(replace(RIPPLE, values={"sine": 2.0, "cosine": 0.0, "n": 9.0}))
    search = told_as(RIPPLE, log, 1.0 * np.sin(18.0 * _position(log)))
    search.steps = search.steps * orders
    take_back_stand_ins(search)
    assert len(search.steps) == (orders if orders > 1 else 0)
    assert all("a law of another form" in why for _, why in search.refused)


def test_a_ripple_beside_which_little_is_left_stays():
    log = log_with(replace(RIPPLE, values={"sine": 4.0, "cosine": 0.0, "n": 9.0}))
    search = told_as(RIPPLE, log, 1.0 * np.sin(18.0 * _position(log)))
    take_back_stand_ins(search)
    assert [s.added.effect for s in search.steps] == ["torque_ripple"]


def test_half_of_what_a_smooth_function_explains_is_no_law():
    log = log_with(duration=LONG)
    q = _position(log)
    bumps = 8.0 * np.exp(-(((q - 0.3) / 0.12) ** 2)) - 6.0 * np.exp(-(((q + 0.35) / 0.1) ** 2))
    search = told_as(RIPPLE, log, bumps)
    search.steps = search.steps * 2  # as if more orders were known
    take_back_stand_ins(search)
    assert not search.steps
    assert "a function of q_joint2" in search.refused[0][1]


def test_what_is_small_beside_what_a_law_took_is_a_detail_of_it():
    log = log_with(replace(SPRING, values={"k": 60.0, "tau0": -6.0}))
    search = told_as(SPRING, log, 0.5 * np.exp(_position(log) / 0.4))
    assert search.current.fit.sigma[1] > 2.0 * search.crossfit.noise[1]
    take_back_stand_ins(search)
    assert [s.added.effect for s in search.steps] == ["joint_spring"]


def test_both_ends_of_a_law_between_two_joints_go():
    """The one end leaves another form; the other one fits by chance and is no law without it."""
    ends = Term("cable_coupling", 1, 0), Term("cable_coupling", 0, 1)
    log = log_with(duration=LONG)
    search = told_as(ends[0], log, 4.0 * np.exp(_position(log, 0) + _position(log)))
    before = search.current
    (score,) = score_terms(Linearization(before, search.folds), [ends[1]], 0)
    after = with_motion_noise(refit(before, (*before.model.terms, ends[1])))
    step = Step(find_term(after, ends[1]), score, (), (), before, after, ())
    search.steps, search.current, search.crossfit = [*search.steps, step], after, cross_fit(after)
    take_back_stand_ins(search)
    assert not search.steps
    assert not {t.identity for t in ends} & {t.identity for t in search.current.model.terms}


def test_an_addition_whose_place_a_later_one_took_is_no_reason_to_fail():
    search = searched(0.0)
    kept = search.steps[0]
    gone = replace(kept, added=Term("time_delay", values={"seconds": 0.02}))
    search.steps = [gone, replace(kept, removed=(gone.added,))]
    for stage in (take_back_shadows, take_back_stand_ins, take_back_events):
        stage(search)
    assert [s.added.effect for s in search.steps] == ["time_delay", "torque_offset"]
    assert not search.refused


@pytest.mark.parametrize("kept_out", [set(), {0}, {1}])
def test_what_a_law_of_another_form_kept_out_is_asked_again_without_it(kept_out):
    log = log_with(duration=LONG)
    search = told_as(SPRING, log, 2.0 * np.exp(_position(log) / 0.4))
    search.kept_out, search.settled = set(kept_out), True
    again = take_back(search)
    assert not search.steps
    # Two laws may hide each other there in any case; every choice is made again where a law was kept out.
    assert again and (kept_out == {1}) == (not search.settled)
    assert search.barred == ({SPRING.identity} if kept_out == {1} else set())
    assert search.kept_out == kept_out - {1}


def test_what_other_motion_refused_hides_nothing_any_more(monkeypatch):
    """Beside a rotor that other motion refused a spring was too small, and was not asked without it."""
    log = log_with(duration=LONG)
    search = told_as(SPRING, log, 20.0 * _position(log))
    search.settled = True
    told = iter([(search.steps[0], "raises the error"), None])
    monkeypatch.setattr(module, "harmful", lambda *a: next(told))
    monkeypatch.setattr(module, "unpredicted", lambda *a: None)
    assert take_back(search) and not search.steps
    assert not search.settled and search.barred == {SPRING.identity}
    assert not search.banned, "laws that are refused beside what harms are asked without it"


def test_what_imitates_any_law_beside_another_one_keeps_its_place_in_mind():
    log = log_with(duration=LONG)
    search = told_as(SPRING, log, 2.0 * np.exp(_position(log) / 0.4))
    search.scores = score_terms(Linearization(search.current, search.folds), [BENT], 0)
    model = search.current.model
    search.current = replace(search.current, model=replace(model, terms=(*model.terms, CUBIC)))
    search.steps = [*search.steps, replace(search.steps[0], added=CUBIC, near=())]
    search.settled = True
    assert that_may_stand(search, search.scores) == []
    # It may have been chosen beside something that was missing: the other is asked in its place.
    assert BENT.effect in [t.effect for t in competitors(search.steps[-1])] and not search.settled
    assert search.kept_out == {1} and search.refused[0][0].effect == "dead_zone_spring"


BRISTLES = Term("hysteresis", 1, values={"fc": 3.0, "x0": 0.05})


def replaced(
    term: Term, plain: tuple[Term, ...], declared: tuple[Term, ...], true: Term = BRISTLES
) -> Search:
    """As if a law had taken the place of plain ones, on a log of bristles on the second joint."""
    motion = prepare(log_with(true, duration=LONG), BAND)
    start = estimate(small_arm(), declared, [motion], bounded=False)
    before = with_motion_noise(refit(start, (*declared, *(t for t in plain if t not in declared))))
    kept = [t for t in before.model.terms if t.identity not in {p.identity for p in plain}]
    after = with_motion_noise(refit(before, (*kept, term)))
    (score,) = score_terms(Linearization(start, cross_fit(start)), [replace(term, values={})], 0)
    step = Step(find_term(after, term), score, (), (), before, after, plain)
    search = Search(after, start, Rules(), 0, Memory(), (), lambda text: None, Budget())
    search.steps, search.crossfit = [step], cross_fit(after)
    return search


def test_a_joint_keeps_its_declared_friction_where_what_took_its_place_is_taken_back(monkeypatch):
    """Without both its errors were those of an arm that nobody had declared."""
    dry = tuple(t for t in blank() if t.joint == 1)
    search = replaced(Term("asymmetric_friction", 1), dry, blank())
    assert not {t.identity for t in dry} & {t.identity for t in search.current.model.terms}
    told = iter([(search.steps[0], "told"), None])
    monkeypatch.setattr(module, "shadow", lambda search: next(told))
    take_back_shadows(search)
    assert not search.steps
    assert {t.identity for t in search.current.model.terms} == {t.identity for t in blank()}


@pytest.mark.parametrize("better", [True, False])
def test_a_law_that_extends_another_stays_only_where_it_is_better(monkeypatch, better):
    """Elements that slip left 1.4 times as much as the bristles whose place they had."""
    plain = Term("hysteresis", 1, values={"fc": 3.0, "x0": 0.05})
    slips = Term("maxwell_slip", 1)
    search = replaced(slips, (plain,), blank())
    if better:
        monkeypatch.setattr(reasons, "survives", lambda *a: None)
    take_back(search)
    named = {t.effect for t in search.current.model.terms if t.joint == 1}
    assert ("maxwell_slip" in named) == better
    assert ("hysteresis" in named) != better


@pytest.mark.parametrize("uneven", [0.0, 0.5])
def test_friction_of_each_direction_stays_only_where_its_halves_differ(uneven):
    """Beside moments of stiction it had taken the place of both, and in motion its halves were one."""
    dry = tuple(t for t in blank() if t.joint == 1)
    each = {"fc_pos": uneven, "fc_neg": 0.0, "b_pos": 0.0, "b_neg": 0.0}
    true = Term("asymmetric_friction", 1, values=each)
    search = replaced(Term("asymmetric_friction", 1), dry, blank(), true)
    take_back(search)
    named = {t.effect for t in search.current.model.terms if t.joint == 1}
    told = {"asymmetric_friction"} if uneven else {t.effect for t in dry}
    assert named == told
    whys = [why for _, why in search.refused]
    assert whys == [] if uneven else "viscous_friction and coulomb_friction" in whys[0]
