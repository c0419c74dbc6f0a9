"""A cable whose ends hide each other is found at both at once; two springs are none."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, blank, log_with, small_arm
from test_other_end import ENDS

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.competing import accepted
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection import both_ends
from jaxswarm.diagnose.selection.both_ends import add_both_ends
from jaxswarm.diagnose.selection.budget import Budget
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

LAWS = ("cable_coupling", "joint_spring", "torque_offset")
SPRINGS = (
    Term("joint_spring", 0, values={"k": 6.0, "tau0": 1.0}),
    Term("joint_spring", 1, values={"k": 10.7, "tau0": -1.3}),
)


def asked(*hidden: Term) -> Search:
    """A search on a log that holds hidden terms, at its first round."""
    log = log_with(*hidden)
    found = with_motion_noise(estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False))
    rules = Rules()
    search = Search(
        found, found, rules, 0, Memory(None, rules.share), (), lambda text: None, Budget(), asked=60
    )
    search.crossfit = cross_fit(found)
    terms = [t for t in eligible_terms(found.model, found.motions) if t.effect in LAWS]
    search.scores = score_terms(Linearization(found, search.folds), terms, 0)
    return search


def test_both_ends_are_added_with_one_stiffness():
    search = asked(*ENDS)
    assert add_both_ends(search, [])
    assert {s.added.place for s in search.steps} == {t.place for t in ENDS}
    for step in search.steps:
        assert find_term(search.current, step.added).values["kc"] == pytest.approx(-8.0, rel=0.02)
    assert search.steps[0].after is search.steps[1].before
    assert search.current is search.steps[1].after


def test_one_end_may_be_small_beside_the_torque_of_its_joint():
    search = asked(*ENDS)
    ((_, *ends),) = both_ends._pairs(search)
    small, large = sorted(s.over_torque for s in ends)
    assert large > 1.2 * small
    search.rules = replace(search.rules, over_torque=1.1 * large)
    assert not add_both_ends(search, [])
    search.rules = replace(search.rules, over_torque=0.5 * (small + large))
    assert add_both_ends(search, [])


def test_one_end_may_be_a_small_part_of_what_its_joint_leaves():
    """Of a true cable one end took 0.19 off its joint's error, at p = 4e-19, and a spring was told for it."""
    search = asked(*ENDS)
    ((_, *ends),) = both_ends._pairs(search)
    for name in ("share", "over_noise"):
        small, large = sorted(getattr(s, name) for s in ends)
        search.rules = replace(Rules(), **{name: 0.5 * (small + large)})
        assert len(both_ends._pairs(search)) == 1
        search.rules = replace(Rules(), **{name: 1.1 * large})
        assert not both_ends._pairs(search)
    # Each is told by itself.
    first, second = both_ends._sized(replace(ends[0], p_value=0.5), ends[1])
    assert first.p_value == 0.5 and first.share == second.share


def test_what_one_end_leaves_may_be_hidden_in_shared_bodies(monkeypatch):
    search = asked(*ENDS)
    sigma = search.current.fit.sigma
    noise = sigma * np.array([1.0, 0.01])
    monkeypatch.setattr(both_ends, "over_noise", lambda found: found.fit.sigma / noise)
    assert add_both_ends(search, [])


def test_what_explains_more_goes_first():
    search = asked(*ENDS)
    more = replace(search.scores[0], gain=1e12)
    assert not add_both_ends(search, [more])


def test_two_springs_are_no_cable():
    search = asked(*SPRINGS)
    assert accepted(search.scores, search.rules)
    assert not add_both_ends(search, [])
    assert not search.steps


def test_joints_near_their_noise_are_not_asked():
    search = asked()
    assert not add_both_ends(search, [])
