"""Friction that nobody declared is found on all joints together, also in a log too short to show each alone."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from planted import BAND, NOISE, log_with, small_arm

from jaxswarm.diagnose import diagnose
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection import everyday
from jaxswarm.diagnose.selection.everyday import _held_out, _hidden, _more_than_clocks
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.forward.model import model_torque
from jaxswarm.identify.synthetic import Noise, synthetic_log
from jaxswarm.logs.motion import prepare

FRICTION = {(e, j) for e in ("viscous_friction", "coulomb_friction") for j in range(2)}


@pytest.mark.parametrize("duration", [4.0, 12.0])
def test_all_friction_is_found_in_one_step(duration):
    found = diagnose(small_arm(), (), [prepare(log_with(duration=duration), BAND)])
    assert {(s.added.effect, s.added.joint) for s in found.kept} == FRICTION
    values = {(t.effect, t.joint): t.values for t in found.final.model.terms}
    assert values["viscous_friction", 0]["b"] == pytest.approx(3.0, rel=0.15)
    assert values["coulomb_friction", 1]["fc"] == pytest.approx(1.5, rel=0.15)


def test_friction_that_a_falling_one_outweighs_is_kept_until_that_is_found():
    """Stribeck friction hides the viscous part of its joint, whose law the other joint shows."""
    falling = Term("stribeck_friction", 1, values={"df": 2.0, "vs": 0.6, "delta": 2.0})
    found = diagnose(small_arm(), (), [prepare(log_with(falling), BAND)])
    added = {(s.added.effect, s.added.joint) for s in found.kept}
    assert added == FRICTION | {("stribeck_friction", 1)}


def test_an_arm_without_friction_gets_none():
    log = synthetic_log(small_arm(), (), 3, noise=NOISE, duration=6.0, rate=125.0, motion_seed=7)
    assert not diagnose(small_arm(), (), [prepare(log, BAND)]).kept


def test_a_weight_told_late_is_no_friction():
    """A controller holds the weight of one joint: read half a sample early, it changes as friction does."""
    log = synthetic_log(
        small_arm(), (), 3, noise=Noise(2e-5, 0.02), duration=12.0, rate=125.0, motion_seed=7
    )
    motion = prepare(log, BAND)
    found = estimate(small_arm(), (), [motion])
    weight = model_torque(found.model, replace(motion, dq=0 * motion.dq, ddq=0 * motion.ddq))[:, 0]
    ahead = 0.5 * motion.interval
    change = np.interp(log.t + ahead, motion.t, weight) - np.interp(log.t, motion.t, weight)
    early = prepare(replace(log, tau=log.tau + change[:, None] * [1.0, 0.0]), BAND)
    told = with_motion_noise(estimate(small_arm(), (), [early]))
    folds = cross_fit(told)
    asked = [Term(effect, 0) for effect in ("viscous_friction", "coulomb_friction")]
    scores = score_terms(Linearization(told, folds), asked, 0)
    assert any(s.gain > 0 for s in scores)
    assert _more_than_clocks(scores, told, folds) == [s for s in scores if s.gain <= 0]
    assert not {"viscous_friction", "coulomb_friction"} & {
        s.added.effect for s in diagnose(small_arm(), (), [early]).kept
    }


def test_what_is_left_in_motion_is_seen_beside_what_friction_leaves_at_rest():
    moving = np.arange(12)[:, None] % 3 > 0
    train = np.arange(12) % 2 == 0
    left = np.where(moving, 1.0, 10.0)
    halves = [SimpleNamespace(train=rows, residual=2.0 * left) for rows in (train, ~train)]
    folds = SimpleNamespace(weight=np.full((12, 1), 2.0), halves=halves)
    assert _held_out(folds, moving).tolist() == [[408.0], [8.0]]


def test_a_rotor_is_found_with_all_friction_in_one_step():
    """That of the first joint is a part of its link's inertia."""
    rotor = Term("rotor_inertia", 1, values={"ia": 0.15})
    found = diagnose(small_arm(), (), [prepare(log_with(rotor), BAND)])
    assert {(s.added.effect, s.added.joint) for s in found.kept} == FRICTION | {rotor.place[:2]}
    assert len({id(s.before) for s in found.kept}) == 1
    told = next(t for t in found.final.model.terms if t.effect == "rotor_inertia")
    assert told.values["ia"] == pytest.approx(0.15, rel=0.1)


def test_what_no_fit_can_tell_is_not_taken_along(monkeypatch):
    monkeypatch.setattr(everyday, "over_noise", lambda after: np.full(3, 10.0))
    law = Term("rotor_inertia").law
    asked = [
        SimpleNamespace(candidate=SimpleNamespace(term=Term(law.name, j)), trained=trained)
        for j, trained in enumerate((0.5, 0.0, 0.2))
    ]
    after = SimpleNamespace()
    assert _hidden(after, asked[:2], asked) == [asked[2]]


def test_what_every_drive_has_is_asked_once_more_beside_what_was_added(monkeypatch):
    rotor, spring = Term("rotor_inertia", 1), Term("joint_spring", 1)
    scores = [SimpleNamespace(candidate=SimpleNamespace(term=t)) for t in (spring, rotor)]
    search = Search(None, None, None, 0, None, (), lambda text: None, None, scores=scores)
    search.crossfit, asked = object(), []

    def add(current, crossfit, scores, rules):
        asked.append([s.candidate.term for s in scores])
        return ["rotor"], "with it"

    monkeypatch.setattr(everyday, "add_everyday", add)
    assert not everyday.everyday_again(search)  # nothing was added that could have hidden it
    search.steps = ["spring"]
    search.refuse(Term("joint_spring", 0))
    assert everyday.everyday_again(search) and not everyday.everyday_again(search)
    assert asked == [[rotor]] and not search.banned
    assert (search.steps, search.current) == (["spring", "rotor"], "with it")
