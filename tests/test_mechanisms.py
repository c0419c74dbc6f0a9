"""Mechanisms of the benchmark of discovery are what they say, and what it needs can be loaded."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.diagnosis_mechanisms import class_right
from benchmarks.mechanism_cases import prepared_case
from benchmarks.mechanisms import MECHANISMS
from benchmarks.worlds.library import joint_library
from jaxswarm.effects.term import Term


def motion(rng):
    return rng.uniform(-1.0, 1.0, (4, 200))


@pytest.mark.parametrize("name", MECHANISMS)
def test_a_mechanism_has_the_parity_that_is_told(name):
    rng = np.random.default_rng(1)
    kind = MECHANISMS[name]
    values = kind.draw(rng)
    q, dq, q_other, dq_other = motion(rng)
    there = kind.torque(values, q, dq, q_other, dq_other)
    back = kind.torque(values, q, -dq, q_other, dq_other)
    assert np.isfinite(there).all() and np.ptp(there) > 0.0
    np.testing.assert_allclose(back, there if kind.parity == "even" else -there, atol=1e-12)


@pytest.mark.parametrize("name", [n for n, kind in MECHANISMS.items() if kind.also_on_other])
def test_what_is_stored_between_two_joints_comes_back(name):
    kind, rng = MECHANISMS[name], np.random.default_rng(2)
    values = kind.draw(rng)
    turn = np.linspace(0.0, 2 * np.pi, 4001)
    q, q_other = 0.4 * np.sin(turn), 0.3 * np.cos(turn) - 0.2
    still = np.zeros_like(q)
    work = np.trapezoid(kind.torque(values, q, still, q_other, still), q)
    work += np.trapezoid(kind.also_on_other(values, q, still, q_other, still), q_other)
    assert abs(work) < 1e-4


def test_a_case_hides_what_it_says():
    case = prepared_case(5)
    hidden = case.hidden
    assert hidden.name == "spring with a dead zone"
    others = [j for j in range(3) if j != hidden.joint]
    assert np.abs(case.extra[:, hidden.joint]).max() > 1.0 and not case.extra[:, others].any()
    assert prepared_case(3).hidden is None


def test_a_mechanism_that_the_catalog_holds_is_told_right_by_its_name():
    hidden = prepared_case(5).hidden
    law = Term("dead_zone_spring", hidden.joint)
    told = [SimpleNamespace(added=law)]
    assert class_right(hidden, told, [])
    assert not class_right(hidden, [SimpleNamespace(added=replace(law, joint=hidden.other))], [])
    assert not class_right(prepared_case(6).hidden, told, [])


def test_the_library_of_the_rivals_holds_finite_columns():
    t = np.arange(0.0, 2.0, 0.01)
    q = np.stack([np.sin(3 * t), np.cos(2 * t)], axis=1)
    log = SimpleNamespace(t=t, q=q, dq=np.gradient(q, t, axis=0), ddq=np.zeros_like(q))
    arm = SimpleNamespace(size=2, sliding=(False, True), width=np.array([0.01, 0.01]))
    sign = np.tanh(log.dq / arm.width)
    labels, columns = zip(*joint_library(arm, log, sign, q, [q, q], 0), strict=True)
    assert "hysteresis@joint1" in labels
    assert all(np.isfinite(c).all() and c.shape == t.shape for c in columns)
