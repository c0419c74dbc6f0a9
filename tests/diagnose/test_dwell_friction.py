"""Friction that grows with rest is named on logs with rests, and not asked elsewhere."""

from dataclasses import replace
from functools import partial

import jax
import numpy as np
import pytest
from elbow import ask, elbow, fitted, passing
from planted import NOISE

from jaxswarm.diagnose.candidates.eligible import eligible_terms, longest_rest
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.logs.log import Log
from jaxswarm.robot import inverse_dynamics

RATE = 125.0
DOUBLES = ("stribeck_friction", "hysteresis", "nonlinear_viscous_friction", "friction_change")
FC, TR, X0 = 3.0, 0.8, 0.08


def stop_and_go(seed: int, steps: int = 16):
    """Steps of 0.9 s with rests of 0.1 to 4 s between them: t (T,), q, dq, ddq (T, 3)."""
    rng = np.random.default_rng(seed)
    rests = np.exp(rng.uniform(np.log(0.1), np.log(4.0), steps))
    parts, place = [], np.zeros(3)
    for k in range(steps):
        still = np.zeros((round(rests[k] * RATE), 3))
        parts.append((place + still, still, still))
        s = np.arange(1, round(0.9 * RATE)) / (0.9 * RATE)
        way = rng.uniform(0.3, 0.9, 3) * -np.sign(place + 0.3 * rng.normal(size=3))
        shapes = (
            10 * s**3 - 15 * s**4 + 6 * s**5,
            (30 * s**2 - 60 * s**3 + 30 * s**4) / 0.9,
            (60 * s - 180 * s**2 + 120 * s**3) / 0.81,
        )
        moved = [np.outer(x, way) for x in shapes]
        parts.append((place + moved[0], moved[1], moved[2]))
        place = place + way
    q, dq, ddq = (np.concatenate(x) for x in zip(*parts, strict=True))
    return np.arange(len(q)) / RATE, q, dq, ddq


def breakaway(t, dq):
    """Extra friction after each rest: by its length, and falling with the way since; told step by step."""
    extra, rest, way, level = np.zeros_like(dq), 0.0, 0.0, 0.0
    for k in range(len(t)):
        if abs(dq[k]) < 0.01:
            rest += 1.0 / RATE
            level, way = -np.expm1(-rest / TR), 0.0
        else:
            rest, way = 0.0, way + abs(dq[k]) / RATE
            extra[k] = FC * level * np.exp(-way / X0) * np.sign(dq[k])
    return extra


def log_of(extra: bool, seed: int = 5) -> Log:
    t, q, dq, ddq = stop_and_go(seed)
    rng = np.random.default_rng(seed)
    rigid = jax.vmap(partial(inverse_dynamics, elbow()))(q, dq, ddq)
    tau = np.asarray(rigid) + 2.0 * dq + 2.0 * np.tanh(dq / 0.01)
    if extra:
        tau[:, 1] += breakaway(t, dq[:, 1])
    return Log(
        source="stop and go",
        joints=elbow().joints,
        t=t,
        q=q + NOISE.position * rng.normal(size=q.shape),
        tau=tau + NOISE.torque * rng.normal(size=q.shape),
    )


def test_breakaway_after_rest_is_named():
    found = fitted(log_of(True))
    scores = ask(found, "dwell_friction", *DOUBLES)
    best = passing(scores)[0]
    assert best.candidate.term.place == ("dwell_friction", 1, None)
    values = find_term(refit_with(found, best), best.candidate.term).values
    assert values["fc"] == pytest.approx(FC, rel=0.4)
    assert values["x0"] == pytest.approx(X0, rel=0.6)


def test_a_log_without_it_stays_as_it_is():
    assert not passing(ask(fitted(log_of(False)), "dwell_friction"))


def test_it_is_not_asked_where_the_joint_does_not_rest():
    found = fitted(log_of(False))
    (motion,) = found.motions
    assert longest_rest((motion,), 1) > 2.0
    t = motion.t
    moving = replace(motion, dq=np.cos(3.0 * t)[:, None] * np.ones(3))
    assert longest_rest((moving,), 1) < 0.1
    asked = {x.effect for x in eligible_terms(found.model, (moving,))}
    assert "hysteresis" in asked and "dwell_friction" not in asked
