"""The driver of the rounds, and the clocks that are moved on the way."""

import importlib
from dataclasses import replace

import pytest
from planted import BAND, blank, declared_fit, log_with, search_of, small_arm

from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.run_against import conclude_comparison
from jaxswarm.diagnose.selection.changes import compare
from jaxswarm.diagnose.selection.rounds import Question, run_rounds
from jaxswarm.diagnose.selection.stepwise import diagnose
from jaxswarm.diagnose.selection.sticking import go_on_from
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.clock_skew import with_skew
from jaxswarm.logs.motion import prepare

clock = importlib.import_module("jaxswarm.diagnose.selection.clock")
rounds = importlib.import_module("jaxswarm.diagnose.selection.rounds")
CLOCK = Term("time_delay")
SPRING = Term("joint_spring", 0, values={"k": 8.0, "tau0": 0.0})


@pytest.fixture(scope="module")
def fitted():
    return declared_fit(log_with(SPRING))


def changing(search, passed):
    """Act on what passed: the model is another one."""
    search.current = replace(search.current)
    return True


def test_the_last_look_is_at_the_model_as_it_is_told(fitted):
    """Whatever would still be allowed for: no round ends with scores of another model than its own."""
    found, crossfit = fitted
    asked, allowed = [], []
    question = Question(
        told=lambda search: "asking",
        cross_fit=lambda search: crossfit,
        eligible=lambda search: asked.append(1) or [replace(SPRING, values={})],
        held=lambda search: set(),
        act=changing,
        allow=lambda *a: bool(allowed.append(1)),
    )
    search = search_of(found)
    run_rounds(search, question, 3)
    assert len(asked) == 4 and len(allowed) == 3
    assert search.ended and search.asked == 1 and len(search.scores) == 1


def test_scores_of_a_round_do_not_stand_beside_those_of_the_next(fitted, monkeypatch):
    """With their columns each is as large as the other; what has been let go of goes back to the system."""
    found, crossfit = fitted
    standing, given, score_terms = [], [], rounds.score_terms
    monkeypatch.setattr(rounds.memory, "give_back", lambda: given.append(1))

    def counted(*asked):
        standing.append(len(search.scores))
        return score_terms(*asked)

    monkeypatch.setattr(rounds, "score_terms", counted)
    question = Question(
        told=lambda search: "asking",
        cross_fit=lambda search: crossfit,
        eligible=lambda search: [replace(SPRING, values={})],
        held=lambda search: set(),
        act=changing,
    )
    search = search_of(found)
    run_rounds(search, question, 1)
    assert standing == [0, 0] and len(search.scores) == 1 and len(given) == 2


def test_a_model_that_refused_something_is_not_asked_anew(fitted, monkeypatch):
    """Each of seven joints was refused a bristle, and 290 laws were asked anew each time, beside one model."""
    found, crossfit = fitted
    asked, passed_on, score_terms = [], [], rounds.score_terms

    def counted(lin, terms, *more):
        asked.append(tuple(terms))
        return score_terms(lin, terms, *more)

    def refuse(search, passed):
        passed_on.append([s.candidate.term for s in passed])
        if not passed:
            return False
        search.refuse(passed[0].candidate.term)
        return True

    monkeypatch.setattr(rounds, "score_terms", counted)
    terms = [Term("joint_spring", 0), Term("cubic_spring", 0)]
    question = Question(
        told=lambda search: "asking",
        cross_fit=lambda search: crossfit,
        eligible=lambda search: [t for t in terms if t.identity not in search.banned],
        held=lambda search: set(),
        act=refuse,
    )
    search = search_of(found)
    run_rounds(search, question, 5)
    assert asked == [tuple(terms)] and [len(p) for p in passed_on] == [2, 1, 0]
    assert search.asked == 2 and not search.scores
    search.ask_again(0)
    terms.append(Term("torque_offset", 0))
    run_rounds(search, question, 5)
    assert len(asked) == 2


@pytest.mark.parametrize("steps", [0, 1])
def test_moved_clocks_hold_for_the_error_before_too(fitted, monkeypatch, steps):
    found, _ = fitted
    monkeypatch.setattr(clock, "clock_skew", lambda one, _: (1e-3, 1e-9))
    search = search_of(found, steps=[None] * steps)
    assert not clock.allow_for_skew(search, [])  # the model has a delay already
    assert clock.allow_for_skew(search, [CLOCK])
    for one in (search.declared, search.current):
        assert one.motions[0].skew == pytest.approx(1e-3)
    monkeypatch.setattr(clock, "clock_skew", lambda one, _: (1e-6, 1e-9))
    assert not clock.allow_for_skew(search, [CLOCK])


def test_clocks_are_moved_as_far_as_is_told_of_them_beside_what_clocks_are(fitted, monkeypatch):
    """Evenly within half a sample: what a log hardly tells moved them by two, a step at a time."""
    found, _ = fitted
    interval = found.motions[0].interval
    search = search_of(found)
    monkeypatch.setattr(clock, "clock_skew", lambda one, _: (-0.8 * interval, 0.1 * interval))
    assert not clock.allow_for_skew(search, [CLOCK])  # surely a delay
    left = -1.2 * interval

    def told(one, _):
        return left - one.motions[0].skew, 0.6 * interval

    monkeypatch.setattr(clock, "clock_skew", told)
    monkeypatch.setattr(clock, "weighted_cost", lambda residual, sigma: 0.0)  # it costs nothing
    assert clock.allow_for_skew(search, [CLOCK])
    assert search.current.motions[0].skew == pytest.approx(0.75 * left / (1.0 + 12.0 * 0.6**2))
    assert not clock.allow_for_skew(search, [CLOCK])


def test_clocks_that_are_not_certain_are_moved_where_that_lowers_the_error(fitted, monkeypatch):
    """Friction that turns late by itself moved a torque that was on time, and raised its squares by half."""
    found, _ = fitted
    interval = found.motions[0].interval
    monkeypatch.setattr(clock, "clock_skew", lambda one, _: (0.9 * interval, 0.4 * interval))
    search = search_of(found)
    assert not clock.allow_for_skew(search, [CLOCK])
    assert search.current is found and search.declared is found
    search = search_of(with_skew(found, 0.7 * interval))
    monkeypatch.setattr(clock, "clock_skew", lambda one, _: (-0.9 * interval, 0.4 * interval))
    assert clock.allow_for_skew(search, [CLOCK])


def test_a_delay_has_to_be_beyond_half_a_sample_for_sure():
    law = Term("time_delay").law
    assert law.credible(-0.0044, interval=0.008, doubt=1e-4)
    assert not law.credible(-0.0044, interval=0.008, doubt=1e-3)
    assert Term("torque_offset", 0).law.credible(0.1, interval=0.008, doubt=1.0)


def test_a_refused_event_is_not_asked_again_and_another_one_is_no_reason(fitted):
    found, _ = fitted
    search = search_of(found)
    event = Term("contact", values={"log": 0.0, "start": 2.0, "end": 2.5})
    search.refuse(event)
    assert replace(event, values={}).identity in search.banned
    assert Term("contact").identity in search.banned


@pytest.mark.parametrize(("changed", "left"), [(0, {1}), (1, {0}), (None, set())])
def test_what_was_refused_is_asked_again_where_the_model_changed(fitted, changed, left):
    """A law of the whole arm was refused for what another joint lacked, and never asked again."""
    found, _ = fitted
    search = search_of(found)
    for term in (Term("torque_lag"), Term("joint_spring", 0), Term("joint_spring", 1)):
        search.refuse(term)
    search.ask_again(changed)
    assert {key[1] for key in search.banned} == left


def test_what_other_motion_refused_is_asked_again_whatever_changes(fitted):
    """A backlash was refused for what another joint lacked on the validation log, which was found next."""
    search = search_of(fitted[0])
    slack, spring = Term("backlash", 1), Term("joint_spring", 1)
    search.refuse(slack, "does not lower the error of all joints", by_all=True)
    search.refuse(spring)
    search.ask_again(0)
    assert search.banned == {spring.identity} and not search.unproven


def test_rules_that_decided_what_changed_are_told():
    motion = prepare(log_with(), BAND)
    model = diagnose(small_arm(), blank(), [motion]).final.model
    found = compare(model, [prepare(log_with(SPRING, seed=4), BAND)], rules=Rules(share=0.35))
    told = conclude_comparison(found, [], 0)[0]
    assert told["rules"]["share"] == 0.35
    assert [e["effect"] for e in told["effects"]] == ["joint_spring"]


def test_what_was_refused_is_asked_again_where_something_changed(fitted):
    """A gain that had harmed another joint was found and taken back once more after a third one's rest."""
    search = search_of(fitted[0])
    gain, friction = Term("drive_gain", 0), Term("cubic_spring", 1)
    for term in (gain, friction, gain):
        search.refuse(term, "raises the error of a joint")
    assert [t for t, _ in search.refused] == [gain, friction]
    search.ask_again(1)
    assert search.banned == {gain.identity}
    go_on_from(search, fitted[0], {0})
    assert not search.banned and search.current is fitted[0]
