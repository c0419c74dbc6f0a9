"""What is made of a long log in parts is what is kept of a short one; nothing as large as its columns stays."""

import importlib

import jax
import numpy as np
import pytest

from jaxswarm.diagnose.candidates import linearization, link_lag, options, swings, whole_model
from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.link_lag import lag_torque
from jaxswarm.diagnose.candidates.propose import propose_all
from jaxswarm.diagnose.folds.partial_out import _fold, cross_fit
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
    monkeypatch.setattr(sensitivity, "BLOCK", 77)
    monkeypatch.setattr(link_lag, "BLOCK", 500)
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
    assert [joint for joint, sensed in rigid.sensed.items() if sensed.asked] == [2]


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
    made, lags = [], swings._lags

    def counted(*given):
        made.append(lags(*given))
        return made[-1]

    monkeypatch.setattr(swings, "_lags", counted)
    pis = np.linspace(0.9, 1.1, sets)[:, None] * PI
    gear = (np.geomspace(300.0, 3e4, 30), np.full(30, 5.0), np.zeros(30), np.zeros(30))
    lag_torque(motion, sensitivity_of(ARM, motion, 1), pis, *gear)
    (at_once,) = {np.shape(x)[1] for lags in made for x in lags}
    assert 1 < len(made) and at_once * len(made) < 30 + at_once
    assert at_once * motion.q.size <= link_lag.MOST_NUMBERS or at_once == 1


def test_options_with_parameters_of_their_own_share_the_columns_of_a_long_log(
    motion, in_parts, monkeypatch
):
    """Those of a million samples were made eleven times, for two gaps each."""
    made, columns_of = [], sensitivity.Sensitivity._columns
    pis = np.linspace(0.9, 1.1, 30)[:, None] * PI
    gear = (np.geomspace(300.0, 3e4, 30), np.full(30, 5.0), np.zeros(30), np.zeros(30))

    def counted(self, part, *given):
        made.append(part)
        return columns_of(self, part, *given)

    monkeypatch.setattr(sensitivity.Sensitivity, "_columns", counted)
    lag_torque(motion, sensitivity_of(ARM, motion, 1), pis, *gear)
    # Twice for every twelve of them.
    assert [part.start for part in made].count(0) == 6
    assert max(part.stop - part.start for part in made) <= 500


def test_options_are_compared_some_at_a_time(monkeypatch):
    rng = np.random.default_rng(3)
    curves, (fold, probe) = rng.normal(size=(40, 60, 2)), _compared(rng)
    whole = options.best_option(probe, fold, curves)
    passed, free_part = [], type(fold).free_part

    def counted(self, columns):
        passed.append(columns.size)
        return free_part(self, columns)

    monkeypatch.setattr(options, "_AT_ONCE", 1000)
    monkeypatch.setattr(type(fold), "free_part", counted)
    assert options.best_option(probe, fold, curves) == whole
    assert max(passed) <= 1000 and sum(passed) == curves.size


def _compared(rng):
    """A fold of one base parameter on the first 40 of 60 rows, and a candidate that speaks of all."""
    train = np.arange(60) < 40
    rows = rng.normal(size=(60, 2, 1))
    fold = _fold(rows, rng.normal(size=(60, 2)), train, 1)
    return fold, Candidate(Term("backlash", 0), (), 3)


def test_a_candidate_keeps_the_curves_it_is_and_none_of_those_that_were_tried(motion):
    """Views of what was picked kept all: 1.1 GB of seven joints, 6,000 rows and a rotor."""
    found = estimate(ARM, parse_terms("viscous_friction,coulomb_friction", ARM.joints), [motion])
    lin = Linearization(found, cross_fit(found))
    terms = (Term("backlash", 1), Term("joint_elasticity", 1))
    for candidate in propose_all(lin, terms, jax.random.key(0)):
        for column in candidate.columns:
            assert column.base is None or column.base.size == column.size
    found = estimate(
        ARM,
        (*found.model.terms, Term("joint_elasticity", 1, values={"k": 1e4, "d": 5.0})),
        [motion],
    )
    lin = Linearization(found, cross_fit(found))
    (candidate,) = propose_all(lin, (Term("hardening_elasticity", 1),), jax.random.key(0))
    assert all(c.base is None or c.base.size == c.size for c in candidate.columns)


def test_of_a_long_log_the_signals_of_few_joints_stand_at_a_time(motion, request, monkeypatch):
    """Derivatives by seven joints and series of twelve are 2.4 GB of a million samples."""
    found = estimate(ARM, parse_terms("viscous_friction,coulomb_friction", ARM.joints), [motion])
    crossfit, kept, made = cross_fit(found), Linearization, []
    terms = [
        Term(name, joint)
        for name in ("encoder_offset", "encoder_eccentricity", "stribeck_friction")
        for joint in range(3)
    ]

    def standing():
        lin = kept(found, crossfit)
        columns = propose_all(lin, tuple(t for t in terms if not t.law.searched), jax.random.key(0))
        for joint in range(3):
            lin._series(0, joint, (joint + 1) % 3)
        return lin, columns

    whole, one = standing()
    assert len(whole.slopes) == 3 and len(whole.series) == 6
    request.getfixturevalue("in_parts")
    monkeypatch.setattr(linearization, "_NUMBERS", 1000)
    found.rigids[0].sensed.clear()
    columns_of = sensitivity.Sensitivity._columns

    def counted(self, part, *given):
        made.append(self.joint)
        return columns_of(self, part, *given)

    monkeypatch.setattr(sensitivity.Sensitivity, "_columns", counted)
    parts, other = standing()
    assert not parts.slopes and len(parts.series) == 2
    assert made == sorted(made) and made.count(0) == -(-len(motion.t) // sensitivity.BLOCK)
    for a, b in zip(one, other, strict=True):
        np.testing.assert_allclose(b.columns[0], a.columns[0], rtol=1e-8, atol=1e-8)


def test_columns_of_another_gravity_are_made_in_parts(motion, monkeypatch):
    """Those of all samples at once are a gigabyte of a million samples of seven joints."""
    found = estimate(ARM, parse_terms("viscous_friction,coulomb_friction", ARM.joints), [motion])
    lin, tilt = Linearization(found, cross_fit(found)), Term("base_tilt", None)
    (whole,) = propose_all(lin, (tilt,), jax.random.key(0))
    made, columns_of = [], columns.rigid_columns

    def counted(robot, q, *given, **more):
        made.append(len(q))
        return columns_of(robot, q, *given, **more)

    for place in (columns, whole_model):
        monkeypatch.setattr(place, "rigid_columns", counted)
    monkeypatch.setattr(columns, "_BLOCK", 500)
    (parts,) = propose_all(Linearization(found, lin.crossfit), (tilt,), jax.random.key(0))
    assert max(made) <= 500 < len(motion.t) <= sum(made)
    for a, b in zip(whole.columns, parts.columns, strict=True):
        np.testing.assert_allclose(b, a, rtol=1e-9, atol=1e-9 * np.abs(a).max())


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
