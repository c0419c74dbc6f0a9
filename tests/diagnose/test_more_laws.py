"""Laws of springs, positions, jumps and zeros: what is planted is named, and not one of its doubles."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest
from planted import BAND, NOISE, added, diagnose_log, log_with

from jaxswarm.diagnose import diagnose
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.worth import passes
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import random_links, synthetic_log
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import robot_from_dh

PLANTED = [
    Term("cubic_spring", 1, values={"k3": 6.0, "q0": 0.3}),
    Term("position_dependent_friction", 0, values={"sine": 2.0, "cosine": -1.0, "n": 2.0}),
    Term("friction_change", 0, values={"fc": 2.0, "t0": 7.0}),
    Term("friction_change", 1, values={"fc": -1.0, "t0": 4.0}),
    Term("cable_coupling", 0, 1, values={"kc": -4.0, "k": 6.0, "tau0": 1.0}),
    Term("gravity_compensator", 0, values={"a": 15.0, "b": 0.6, "q0": 0.2}),
]


@pytest.mark.parametrize("term", PLANTED, ids=lambda t: f"{t.effect}@{t.joint}")
def test_what_is_planted_is_named_with_its_values(term):
    found = diagnose_log(log_with(term))
    assert added(found) == [(term.effect, term.joint)]
    fitted = found.steps[0].added.values
    for name in ("k3", "q0", "n", "fc", "t0", "kc", "k", "dq0"):
        if name in term.values:
            assert fitted[name] == pytest.approx(term.values[name], rel=0.25), name


@pytest.mark.parametrize(
    ("joint", "k", "ends"),
    [(0, 12.0, {"low": -1.0, "high": -0.2}), (0, 12.0, {"low": -0.2}), (1, 20.0, {"high": 0.3})],
)
def test_of_a_spring_with_slack_the_ends_are_told_that_the_motion_reaches(joint, k, ends):
    low, high = ends.get("low", -2.5), ends.get("high", 2.5)
    law = Term(
        "dead_zone_spring", joint, values={"k": k, "q0": (low + high) / 2, "gap": (high - low) / 2}
    )
    found = diagnose_log(log_with(law))
    assert added(found) == [("dead_zone_spring", joint)]
    fitted = found.steps[0].added
    assert fitted.values["k"] == pytest.approx(k, rel=0.05)
    told = fitted.law.derived(fitted.values)
    assert {name: told[name][0] for name in ends} == pytest.approx(ends, abs=0.02)


def test_a_stop_is_found_on_the_way_of_a_slide():
    """That of a world was told as a cubic spring and a ripple of one period: points lay 0.4 m apart."""
    slide = robot_from_dh(
        "slide",
        convention="modified",
        alpha=[0.0],
        a=[0.0],
        d=[0.0],
        kinds=["prismatic"],
        gravity=[0, 0, 0],
    )
    friction = parse_terms("viscous_friction,coulomb_friction", slide.joints)
    rng = np.random.default_rng(0)
    t = np.arange(3000) * 0.01
    waves = [(0.11, 0.21, 0.3), (0.07, 0.53, 1.0), (0.04, 0.97, 2.0)]
    q = sum(a * np.sin(2 * np.pi * f * t + p) for a, f, p in waves)
    dq = np.gradient(q, t)
    x = q - 0.015
    tau = 20.0 * np.gradient(dq, t) + 30.0 * dq + 5.0 * np.tanh(dq / 0.01)
    tau += 400.0 * np.sign(x) * np.maximum(np.abs(x) - 0.05, 0.0) + 0.7 * rng.normal(size=len(t))
    log = Log("slide", slide.joints, t, q[:, None], tau=tau[:, None])
    found = diagnose(slide, friction, [prepare(log, BAND)])
    assert added(found) == [("dead_zone_spring", 0)]
    fitted = found.steps[0].added.values
    assert fitted == pytest.approx({"k": 400.0, "q0": 0.015, "gap": 0.05}, rel=0.1)


def test_a_wrong_zero_is_seen_in_the_torque_of_the_links_beyond():
    bare = robot_from_dh(
        "elbow",
        convention="modified",
        alpha=[0.0, np.pi / 2, np.pi / 2],
        a=[0, 0, 0.4],
        d=[0, 0, 0],
    )
    arm = bare.replace(
        parameters=jnp.asarray(random_links(bare, np.random.default_rng(3), mass=6.0))
    )
    friction = parse_terms("viscous_friction", arm.joints)
    declared = tuple(replace(t, values={"b": 2.0}) for t in friction)
    truth = Term("encoder_offset", 1, values={"dq0": 0.06})
    log = synthetic_log(arm, (*declared, truth), 1, noise=NOISE, duration=12.0, rate=125.0)
    found = estimate(arm, friction, [prepare(log, BAND)], bounded=False)
    candidates = [*(Term(truth.effect, j) for j in range(3)), Term("base_tilt")]
    scores = score_terms(Linearization(found, cross_fit(found)), candidates, 0)
    best = max(scores, key=lambda s: s.gain)
    assert best.candidate.term.place == truth.place
    assert passes(best, 40, Rules()) and best.joint == 2
    after = refit_with(found, best)
    fitted = next(t for t in after.model.terms if t.place == truth.place)
    assert fitted.values["dq0"] == pytest.approx(0.06, rel=0.1)
