"""Friction that nobody declared is found on all joints together, also in a log too short to show each alone."""

import pytest
from planted import BAND, NOISE, log_with, small_arm

from jaxswarm.diagnose import diagnose
from jaxswarm.effects.term import Term
from jaxswarm.identify.synthetic import synthetic_log
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
