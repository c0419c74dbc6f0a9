"""What is made of a long log in parts is what is kept of a short one; nothing as large as its columns stays."""

import importlib

import jax
import numpy as np
import pytest

from jaxswarm.diagnose.candidates import link_lag
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.link_lag import lag_torque
from jaxswarm.diagnose.candidates.propose import propose_all
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects.lattice import batch_of
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify.estimation.estimate import estimate
from jaxswarm.identify.forward import columns, sensitivity
from jaxswarm.identify.forward.columns import rigid_of
from jaxswarm.identify.forward.sensitivity import sensitivity_of
from jaxswarm.identify.synthetic import demo_case, random_links, synthetic_log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import rx60

ARM = rx60()
PI = random_links(ARM, np.random.default_rng(0)).ravel()


@pytest.fixture(scope="module")
def motion():
    arm, declared, _ = demo_case(ARM, 5)
    return prepare(synthetic_log(arm, declared, 5, duration=8.0))


@pytest.fixture
def in_parts(monkeypatch):
    lattice = importlib.import_module("jaxswarm.effects.lattice")
    monkeypatch.setattr(columns, "_KEPT", 0)
    monkeypatch.setattr(sensitivity, "_BLOCK", 77)
    monkeypatch.setattr(link_lag, "MOST_NUMBERS", 20_000)
    monkeypatch.setattr(lattice, "_HELD", 2**14)


@pytest.mark.parametrize("joint", range(3))
def test_slopes_in_parts_are_those_of_the_whole(motion, joint, request):
    many = np.stack([PI, 1.1 * PI])
    asked = (PI, PI[None], many)

    def found():
        rigid = rigid_of(ARM, motion)
        own = sensitivity_of(ARM, motion, joint, rigid)
        kept = "full" in vars(rigid)
        return (
            [own.at(pi) for pi in asked],
            own.at(many, slice(1, 2)),
            own.inertia(PI),
            own.own(),
            kept,
        )

    whole = found()
    request.getfixturevalue("in_parts")
    parts = found()
    assert (whole[-1], parts[-1]) == (True, False)
    for one, other in zip(jax.tree.leaves(whole[:-1]), jax.tree.leaves(parts[:-1]), strict=True):
        np.testing.assert_allclose(other, one, rtol=1e-9, atol=1e-9 * np.abs(one).max())


def test_a_long_log_keeps_the_slopes_of_one_joint(motion, in_parts):
    rigid = rigid_of(ARM, motion)
    for joint in range(3):
        sensitivity_of(ARM, motion, joint, rigid).at(PI)
    assert list(rigid.sensed) == [2]


@pytest.mark.parametrize("own", [False, True])
@pytest.mark.parametrize("sets", [1, 30])
def test_lags_of_some_options_at_a_time_are_those_of_all(motion, sets, own, request):
    k, d, gap = np.geomspace(300.0, 3e4, 30), np.full(30, 5.0), np.linspace(0.0, 0.01, 30)
    hard = np.zeros(30)
    pis = np.linspace(0.9, 1.1, sets)[:, None] * PI

    def found():
        return lag_torque(motion, sensitivity_of(ARM, motion, 1), pis, k, d, gap, hard, own=own)

    whole = found()
    request.getfixturevalue("in_parts")
    assert motion.q[:, : 1 if own else None].size * 30 > link_lag.MOST_NUMBERS
    np.testing.assert_allclose(found(), whole, rtol=1e-7, atol=1e-7 * np.abs(whole).max())


@pytest.mark.parametrize("sets", [1, 30])
def test_lags_of_a_long_log_are_made_of_no_more_options_than_pass_at_a_time(
    motion, sets, in_parts, monkeypatch
):
    """Seven joints and a million samples took 1.7 GB for 72 options of which two were asked."""
    made, lags = [], link_lag._lags

    def counted(*given):
        made.append(lags(*given))
        return made[-1]

    monkeypatch.setattr(link_lag, "_lags", counted)
    pis = np.linspace(0.9, 1.1, sets)[:, None] * PI
    gear = (np.geomspace(300.0, 3e4, 30), np.full(30, 5.0), np.zeros(30), np.zeros(30))
    lag_torque(motion, sensitivity_of(ARM, motion, 1), pis, *gear)
    (at_once,) = {np.shape(x)[1] for swings in made for x in swings}
    assert 1 < len(made) and at_once * len(made) < 30 + at_once
    assert at_once * motion.q.size <= link_lag.MOST_NUMBERS or at_once == 1


def test_candidates_of_a_long_log_are_those_of_a_short_one(motion, request):
    found = estimate(ARM, parse_terms("viscous_friction,coulomb_friction", ARM.joints), [motion])
    crossfit = cross_fit(found)
    terms = tuple(
        Term(name, joint)
        for name in ("backlash", "joint_elasticity", "encoder_offset", "torque_ripple")
        for joint in (0, 2)
    ) + (Term("payload_change", None),)

    def columns():
        lin = Linearization(found, crossfit)
        return propose_all(lin, terms, jax.random.key(0))

    whole = columns()
    request.getfixturevalue("in_parts")
    assert batch_of(len(motion.t), 36) < 36
    found.rigids[0].sensed.clear()
    for one, other in zip(whole, columns(), strict=True):
        assert other.term.values == pytest.approx(one.term.values, rel=1e-6)
        for a, b in zip(one.columns, other.columns, strict=True):
            np.testing.assert_allclose(b, a, rtol=1e-6, atol=1e-6 * np.abs(a).max())
