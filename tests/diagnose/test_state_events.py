"""A window in which the position says as much as the time is no event; a push stays one."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from planted import BAND, DECLARED, NOISE, RATE, blank, log_with, small_arm

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.noise import noise_of, with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection import state_events
from jaxswarm.diagnose.selection.budget import Budget
from jaxswarm.diagnose.selection.event_at_rest import (
    held_within,
    like_other_rests,
    rows_within,
)
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import Step, find_term
from jaxswarm.diagnose.selection.take_back import take_back_events, take_back_stand_ins
from jaxswarm.diagnose.selection.without_end import jumps_for_events
from jaxswarm.effects.base import REGISTRY, get_law
from jaxswarm.effects.direction import follows_direction
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import fourier_motion, synthetic_log
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import prepare

LONG = 30.0


def told_as_contacts(extra, count: int) -> Search:
    """As if contacts had been added to a log with a further torque of joint 2, ``extra(log)`` [N m]."""
    return told_as([Term("contact")] * count, lambda log: np.stack([0.0 * log.t, extra(log)], 1))


def told_as(terms, extra, motion_seed: int = 7) -> Search:
    """As if terms had been added, one after the other, to a log with a further torque (T, 2) [N m]."""
    log = log_with(duration=LONG, motion_seed=motion_seed)
    tau = log.tau + extra(log)
    motion = prepare(replace(log, tau=tau), BAND)
    declared = with_motion_noise(estimate(small_arm(), blank(), [motion], bounded=False))
    search = Search(declared, declared, Rules(), 0, Memory(), (), lambda text: None, Budget())
    search.crossfit = cross_fit(declared)
    for term in terms:
        before = search.current
        (score,) = score_terms(Linearization(before, search.folds), [term], 0)
        after = with_motion_noise(refit_with(before, score))
        added = find_term(after, score.candidate.term)
        search.steps = [*search.steps, Step(added, score, (), (), before, after, ())]
        search.current, search.crossfit = after, cross_fit(after)
    return search


def cushion(log):
    """At one end of the travel [N m]."""
    return 3.0 * np.exp((log.q[:, 1] - 0.5) / 0.15)


def push(log):
    """Half a second of 6 N m."""
    return 6.0 * ((log.t > 9.0) & (log.t < 9.5))


def test_a_cushion_is_no_row_of_contacts():
    search = told_as_contacts(cushion, 2)
    take_back_events(search)
    assert not search.steps
    assert not any(t.effect == "contact" for t in search.current.model.terms)
    (_, why) = search.refused[0]
    assert "a function of q_joint2" in why and "no event is needed" in why


@pytest.mark.parametrize(("there", "told"), [(cushion, True), (lambda log: 0.0 * log.t, False)])
def test_a_function_instead_of_events_is_not_contradicted_by_another_log(there, told):
    """Two positions told 86 % of what a load did that was picked up, and made another log 2.6 times worse."""
    search = told_as_contacts(cushion, 2)
    log = log_with(duration=LONG, motion_seed=11)
    tau = log.tau + np.stack([0.0 * log.t, there(log)], 1)
    search.other = (prepare(replace(log, tau=tau), BAND),)
    take_back_events(search)
    assert any("a function of q_joint2" in why for _, why in search.refused) is told


def test_a_push_stays_an_event():
    search = told_as_contacts(push, 1)
    take_back_events(search)
    assert [s.added.effect for s in search.steps] == ["contact"]


def test_a_push_stays_one_beside_a_law_of_the_position_that_nobody_knows():
    search = told_as_contacts(lambda log: push(log) + 2.0 * np.sin(6.0 * log.q[:, 1]), 1)
    assert abs(search.steps[0].added.values["start"] - 9.0) < 0.1
    take_back_events(search)
    assert [s.added.effect for s in search.steps] == ["contact"]


@pytest.mark.parametrize(("share", "stays"), [(0.83, True), (0.9999, False)])
def test_an_event_that_leaves_far_less_than_the_positions_do_is_one(monkeypatch, share, stays):
    """Positions that were reached once told most of a load that was picked up, at 18 times the noise."""
    search = told_as_contacts(push, 1)
    told = SimpleNamespace(depends_on=("q_joint1", "q_joint2"), share=share)
    monkeypatch.setattr(state_events, "find_unexplained", lambda *args: [told])
    monkeypatch.setattr(state_events, "_share_within", lambda *args: share)
    take_back_events(search)
    assert bool(search.steps) is stays


def test_laws_that_look_at_the_direction_are_told_from_those_of_the_position_alone():
    asked = [
        x for x in REGISTRY.values() if isinstance(x, TorqueLaw) and x.shown_against == "position"
    ]
    still = {x.name for x in asked if not follows_direction(x)}
    assert {"joint_spring", "cubic_spring", "dead_zone_spring", "torque_ripple"} <= still
    assert follows_direction(get_law("position_dependent_friction"))
    assert not any(x.dissipative or x.rate is not None for x in asked if x.name in still)


def test_what_a_law_hid_is_asked_again_once_that_is_taken_back():
    """A spring of another form on joint 2, and contacts that are a cushion of joint 1."""

    def extra(log):
        cushion_of = 9.0 * np.exp((log.q[:, 0] - 0.3) / 0.15)
        return np.stack([cushion_of, np.exp(log.q[:, 1] / 0.4)], 1)

    search = told_as([Term("joint_spring", 1), Term("contact")], extra)
    assert [s.score.joint for s in search.steps] == [1, 0]
    take_back_stand_ins(search)
    assert not search.steps


def direction(log):
    """Direction of joint 2, (T,)."""
    return np.tanh(np.gradient(log.q[:, 1], log.t) / 0.01)


def by_partner(log):
    """Friction of joint 2 by the position of joint 1 [N m]."""
    return np.stack([0.0 * log.t, 3.0 * log.q[:, 0] * direction(log)], 1)


def change(log):
    """Friction of joint 2 that changes at 14 s [N m]."""
    return np.stack([0.0 * log.t, 1.5 * (log.t > 14.0) * direction(log)], 1)


@pytest.mark.parametrize(("extra", "stays"), [(by_partner, False), (change, True)])
def test_friction_by_the_partner_is_no_friction_that_changed(extra, stays):
    """A law by the time was kept at 1.4 times the noise, and raised the error of other motion by half."""
    search = told_as([Term("friction_change", 1)], extra, motion_seed=10)
    take_back_events(search)
    assert bool(search.steps) is stays
    if not stays:
        assert "no time is needed" in search.refused[0][1]


@pytest.mark.parametrize(("there", "told"), [(by_partner, True), (change, False)])
def test_a_function_instead_of_a_law_by_the_time_holds_on_another_log(there, told):
    """What friction lost as its joint warmed was 84 % a function of another's speed, 12 % of it elsewhere."""
    search = told_as([Term("friction_change", 1)], by_partner, motion_seed=10)
    log = log_with(duration=LONG, motion_seed=11)
    search.other = (prepare(replace(log, tau=log.tau + there(log)), BAND),)
    assert (state_events.time_of_state(search) is not None) == told


@pytest.mark.parametrize(("over", "told"), [(1.2, False), (1.4, True)])
def test_a_law_by_the_time_that_leaves_the_noise_alone_is_not_asked_for_states(
    monkeypatch, over, told
):
    """Of friction that fell at once a function of two joints with 96 numbers told 95 %, the law 93 %."""
    search = told_as([Term("friction_change", 1)], by_partner, motion_seed=10)
    monkeypatch.setattr(state_events, "over_noise", lambda found: np.array([over, over]))
    assert (state_events.time_of_state(search) is not None) == told


def jump(log):
    """From 22 s on, to the end [N m]."""
    return 3.0 * (log.t > 22.0)


@pytest.mark.parametrize(
    ("pushed", "told"),
    [
        (lambda log: np.stack([0.0 * log.t, jump(log)], 1), "offset_change"),
        (lambda log: np.stack([jump(log), jump(log)], 1), "contact"),
        (lambda log: np.stack([0.0 * log.t, jump(log) * (log.t < 25.0)], 1), "contact"),
    ],
)
def test_an_event_of_one_joint_without_an_end_is_a_jump(pushed, told):
    """A torque's zero that jumped 4.5 s before its log was over was told as a contact until then."""
    search = told_as([], pushed)
    lin = Linearization(search.current, search.folds)
    asked = [Term("contact"), Term("offset_change", 1), Term("friction_change", 1)]
    event, *laws = score_terms(lin, asked, 0)
    assert event.candidate.term.effect == "contact" and event.allowed
    (found,) = jumps_for_events([event], [event, *laws], search.current)
    assert found.candidate.term.effect == told


def one_way(log):
    """A dashpot that acts in one direction beyond an angle [N m]: strokes of several sizes."""
    speed = np.gradient(log.q[:, 1], log.t)
    return 40.0 * np.maximum(speed, 0.0) ** 1.5 * np.maximum(log.q[:, 1] - 0.2, 0.0)


def no_function(monkeypatch):
    """As if no function of the motion held: of few strokes none predicts the others' torque."""
    monkeypatch.setattr(state_events, "find_unexplained", lambda *args: [])


def test_strokes_of_one_direction_are_no_pushes(monkeypatch):
    search = told_as_contacts(one_way, 3)
    no_function(monkeypatch)
    take_back_events(search)
    assert not search.steps
    (_, why) = search.refused[0]
    assert "go by q_joint2 and dq_joint2" in why and "no event is needed" in why


def test_two_passes_of_one_place_are_no_pushes_whichever_way_they_go(monkeypatch):
    """Friction at a tooth was told as three contacts, to either side."""
    search = told_as_contacts(push, 1)
    own, t = search.steps[0].added, search.current.regression.t
    there = np.interp(t, [0.0, 0.5 * LONG, LONG], [-1.0, 1.0, -1.0])  # once up, once down
    table = {"q_joint2": there, "dq_joint2": np.gradient(there, t)}
    table = {name: SimpleNamespace(raw=raw) for name, raw in table.items()}
    monkeypatch.setattr(state_events, "table_of", lambda found: table)

    def told(*begins):
        events = [replace(own, values={**own.values, "start": b, "end": b + 1.5}) for b in begins]
        return state_events._of_like_states(search.current, 1, events)

    why = told(9.0, LONG - 10.5)
    assert why is not None and "go by q_joint2:" in why
    assert told(9.0, LONG - 6.0) is None


def test_pushes_at_any_time_stay_events():
    search = told_as_contacts(push, 1)
    own = search.steps[0].added
    later = replace(own, values={**own.values, "start": 21.0, "end": 21.6})
    assert state_events._of_like_states(search.current, 1, [own]) is None
    assert state_events._of_like_states(search.current, 1, [own, later]) is None


def test_strokes_that_the_joints_before_feel_stay_events(monkeypatch):
    """What is pushed at the end of every stroke is felt on both joints: the surroundings' doing."""
    search = told_as(
        [Term("contact")] * 3, lambda log: np.stack([0.5 * one_way(log), one_way(log)], 1)
    )
    no_function(monkeypatch)
    take_back_events(search)
    assert len(search.steps) == 3


def with_rests() -> Log:
    """Joint 2 goes from point to point in 1.3 s and rests for 0.2 s, joint 1 goes on."""
    rng = np.random.default_rng(7)
    t, *moved = fourier_motion(2, rng, LONG, RATE)
    q, dq, ddq = (np.array(x) for x in moved)
    points = rng.uniform(-1.0, 1.0, 1 + int(LONG / 1.5))
    number, phase = np.divmod(t, 1.5)
    s = np.minimum(phase / 1.3, 1.0)
    step = np.append(np.diff(points), 0.0)[number.astype(int)]
    q[:, 1] = points[number.astype(int)] + step * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    dq[:, 1] = step / 1.3 * 30.0 * s**2 * (1.0 - s) ** 2
    ddq[:, 1] = step / 1.3**2 * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s)
    return synthetic_log(small_arm(), DECLARED, 1, noise=NOISE, rate=RATE, moved=(t, q, dq, ddq))


def held(sizes):
    """Dry friction that holds joint 2 at one of these torques [N m] in each of its rests."""

    def extra(log):
        number, phase = np.divmod(log.t, 1.5)
        drawn = np.random.default_rng(4).permutation(np.resize(sizes, 1 + int(LONG / 1.5)))
        return np.where(phase >= 1.3, drawn[number.astype(int)], 0.0)

    return extra


@pytest.mark.parametrize(("size", "alike"), [(1.5, True), (-9.0, False)])
def test_a_rest_is_an_event_only_by_more_than_other_rests_have(size, alike):
    log = with_rests()
    torque = held((1.5, -1.0, 1.2, -1.6))(log)
    here = (log.t >= 14.8) & (log.t < 15.0)
    torque[here] = size
    tau = log.tau + np.stack([0.0 * torque, torque], axis=1)
    event = Term("contact", values={"start": 14.8, "end": 15.0, "log": 0.0})
    motion = prepare(replace(log, tau=tau), BAND)
    found = with_motion_noise(estimate(small_arm(), (*blank(), event), [motion], bounded=False))
    told = find_term(found, event)
    assert abs(told.values["tau_joint2"]) > 5.0 * noise_of(found)[1]
    assert like_other_rests(found, told) == alike
    # The same torque where the joint moves is no rest.
    moving = replace(told, values=told.values | {"start": 14.0, "end": 14.2})
    assert not like_other_rests(found, moving)


def test_an_event_that_is_a_rest_is_taken_back(monkeypatch):
    search = told_as_contacts(push, 1)
    monkeypatch.setattr(state_events, "like_other_rests", lambda found, added: True)
    take_back_events(search)
    assert not search.steps and "told by a rest" in search.refused[0][1]


def replace_motion(search, motion):
    search.current = replace(search.current, motions=(motion,))
    return search


@pytest.mark.parametrize(
    "sticking, first, held",
    [({1}, 0.0, True), ({1}, 5.0, False), ({0, 1}, 5.0, True), (set(), 0.0, False)],
)
def test_a_push_is_told_by_a_rest_only_where_all_joints_it_acts_on_rest(sticking, first, held):
    """An arm was pushed while its last joint stood, which told most of it."""
    search = told_as_contacts(push, 1)
    (step,), current = search.steps, search.current
    (motion,), rest = current.motions, np.zeros(current.regression.torque.shape, bool)
    # None of the window is used for anything else, at rest or not.
    assert not current.regression.used_rows[rows_within(current, step.added)].any()
    search.sticking = sticking
    assert not held_within(replace_motion(search, replace(motion, held=rest)), step)
    rest[np.ix_(rows_within(current, step.added), list(sticking))] = True
    replace_motion(search, replace(motion, held=rest))
    step.added.values["tau_joint1"] = first
    assert step.score.joint == 1 and held_within(search, step) == held


def load(log):
    """Something heavy is picked up after twelve seconds [N m]."""
    body = dict.fromkeys(("mcy", "mcz", "Ixy", "Ixz", "Iyz"), 0.0)
    body |= {"m": 0.6, "mcx": 0.06, "Ixx": 0.002, "Iyy": 0.01, "Izz": 0.01}
    held = Term("payload_change", values=body | {"start": 12.0, "end": 1e5, "log": 0.0})
    return log_with(held, duration=LONG).tau - log_with(duration=LONG).tau


@pytest.mark.parametrize("of_its_value, told", [(0.1, 1), (0.4, 0)])
def test_a_load_is_one_by_a_number_that_is_told_from_zero(monkeypatch, of_its_value, told):
    """Of ten numbers one may be 2.5 standard errors from zero by chance."""
    search = told_as([Term("payload_change")], load)
    term = search.steps[0].added
    errors = {name: of_its_value * abs(value) for name, value in term.values.items()}
    monkeypatch.setattr(state_events, "with_errors", lambda added, found: (term, errors))
    take_back_events(search)
    assert len(search.steps) == told
    assert told or "no number is told from zero" in search.refused[0][1]
