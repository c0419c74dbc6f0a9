"""A log in parts gives the numbers that the whole gives: torques, decimated columns, fits and their doubt."""

import importlib
from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify.estimation.estimate import estimate
from jaxswarm.identify.estimation.validate import held_out_residual
from jaxswarm.identify.forward import columns
from jaxswarm.identify.forward.columns import rigid_of
from jaxswarm.identify.forward.measuring_chain import assemble
from jaxswarm.identify.forward.model import linear_values, model_torque
from jaxswarm.identify.synthetic import demo_case, synthetic_log
from jaxswarm.logs import lost
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import rx60

EFFECTS = "viscous_friction,coulomb_friction,load_dependent_friction@joint2"


@pytest.fixture(scope="module")
def log():
    arm, declared, _ = demo_case(rx60(), 3)
    hidden = Term("load_dependent_friction", 1, values={"mu": 0.05, "inertial": 1.0})
    return synthetic_log(arm, (*declared, hidden), 3, duration=10.0)


@pytest.fixture(scope="module")
def whole(log):
    return estimate(rx60(), parse_terms(EFFECTS, rx60().joints), [prepare(log)])


def in_parts(monkeypatch):
    monkeypatch.setattr(columns, "_BLOCK", 333)
    monkeypatch.setattr(columns, "_KEPT", 0)
    monkeypatch.setattr(lost, "_ROWS", 100)


def test_fit_in_parts_is_the_fit_of_the_whole(log, whole, monkeypatch):
    in_parts(monkeypatch)
    parts = estimate(rx60(), whole.model.terms, [prepare(log)], width=whole.model.width)
    assert "full" not in vars(parts.rigids[0])
    monkeypatch.undo()
    again = estimate(rx60(), whole.model.terms, [prepare(log)], width=whole.model.width)
    np.testing.assert_allclose(parts.fit.values, again.fit.values, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(parts.fit.std_error, again.fit.std_error, rtol=1e-6)
    np.testing.assert_allclose(parts.fit.residual, again.fit.residual, atol=1e-8)
    for one, other in zip(parts.std_errors, again.std_errors, strict=True):
        assert one == pytest.approx(other, rel=1e-6)


def test_torque_needs_no_columns(whole, monkeypatch):
    model, motion = whole.model, whole.motions[0]
    pi = np.asarray(model.robot.parameters).ravel()
    width = model.width
    expected = assemble(model.robot, model.terms, motion, width, pi) @ linear_values(model)
    in_parts(monkeypatch)
    np.testing.assert_allclose(model_torque(model, motion), expected, atol=1e-9)


# Two terms each: what a drive distorts is the torque with what the other term supplies.
@pytest.mark.parametrize(
    "added",
    [
        "payload_change,torque_constant_saturation@joint2",
        "link_geometry@joint3,torque_dead_band@joint1",
        "encoder_eccentricity@joint2,payload_change",
        "torque_lag,load_dependent_friction@joint2",
        "contact,torque_constant_saturation@joint3",
    ],
)
def test_torque_is_that_of_the_columns_whatever_a_model_holds(whole, monkeypatch, added):
    model, motion = whole.model, whole.motions[0]
    rng = np.random.default_rng(0)
    terms = []
    for term in parse_terms(added, model.robot.joints):
        linear = term.linear_names(model.robot.joints)
        drawn = dict(zip(linear, 0.05 * rng.uniform(size=len(linear)), strict=True))
        times = {"start": 2.0, "end": 7.0, "log": 0.0}
        given = {p.name: times.get(p.name, 0.01) for p in term.law.nonlinear}
        terms.append(replace(term, values={**given, **drawn}))
    model = replace(model, terms=(*model.terms, *terms))
    theta, pi = linear_values(model), np.asarray(model.robot.parameters).ravel()
    place = (model.robot, model.terms, motion, model.width)
    expected = assemble(*place, pi) @ theta
    rigid = rigid_of(whole.model.robot, motion)
    np.testing.assert_allclose(assemble(*place, pi, rigid) @ theta, expected, atol=1e-7)
    in_parts(monkeypatch)
    np.testing.assert_allclose(model_torque(model, motion), expected, atol=1e-7)
    base = model_torque(replace(model, terms=whole.model.terms), motion)
    assert np.abs(expected - base).max() > 1e-4


def test_each_block_is_predicted_by_a_fit_to_the_others(whole):
    regression, solution = whole.regression, whole.fit
    block = np.arange(len(regression.t)) * 3 // len(regression.t)
    residual = held_out_residual(whole, block=block)
    kept = regression.columns[:, :, solution.base.kept] / solution.sigma[:, None]
    target = regression.target / solution.sigma
    for b in range(3):
        rows = np.concatenate([kept[block != b].reshape(-1, kept.shape[2]), solution.prior])
        wanted = np.append(target[block != b].ravel(), np.zeros(len(solution.prior)))
        values = np.linalg.lstsq(rows, wanted, rcond=None)[0]
        left = (target[block == b] - kept[block == b] @ values) * solution.sigma
        np.testing.assert_allclose(residual[block == b], left, atol=1e-7)


def test_missing_samples_are_found_part_by_part(log, monkeypatch):
    import dataclasses

    kept = np.ones(len(log.t), bool)
    kept[np.random.default_rng(0).choice(len(kept), len(kept) // 10, replace=False)] = False
    t = log.t[: kept.sum()]
    short = dataclasses.replace(log, t=t, q=log.q[kept], tau=log.tau[kept], channels={})
    monkeypatch.setattr(lost, "_ROWS", len(log.t))
    whole = lost.lost_samples(short)
    monkeypatch.setattr(lost, "_ROWS", 97)
    assert lost.lost_samples(short) == whole and len(whole) == 1


def test_laws_of_a_model_share_the_load_they_go_by(whole, monkeypatch):
    rigid = rigid_of(rx60(), whole.motions[0])
    motion, made, along = rigid.motion, [], columns.load_along

    def counted(*given):
        made.append(given)
        return along(*given)

    monkeypatch.setattr(columns, "load_along", counted)
    monkeypatch.setattr(columns, "_KEPT", 0)
    drawn = np.random.default_rng(0).normal(size=(3, 30))
    for number, pi in enumerate((*drawn, drawn[0]), 1):
        for _ in range(2):
            own = rigid.load(pi.copy())
            fresh = along(rigid.robot, (motion.q, motion.dq, motion.ddq), pi)
            np.testing.assert_array_equal(own.full, fresh.full)
            np.testing.assert_array_equal(own.static, fresh.static)
        assert len(made) == number


def test_a_load_is_the_product_of_columns_that_are_kept(whole):
    rigid = rigid_of(rx60(), whole.motions[0])
    motion, pi = rigid.motion, np.random.default_rng(0).normal(size=30)
    fresh = columns.load_along(rigid.robot, (motion.q, motion.dq, motion.ddq), pi)
    own = rigid.load(pi)
    np.testing.assert_allclose(own.full, fresh.full, rtol=1e-10, atol=1e-11)
    np.testing.assert_allclose(own.static, fresh.static, rtol=1e-10, atol=1e-11)


def test_no_more_columns_stand_in_memory_than_a_search_looks_at(log, monkeypatch):
    import gc
    import weakref

    steps = importlib.import_module("jaxswarm.identify.estimation.problem")
    alive, most = [], []

    def counted(*given, **how):
        gc.collect()
        most.append(sum(one() is not None for one in alive))
        made = build(*given, **how)
        alive.append(weakref.ref(made))
        return made

    build = steps.build_regression
    monkeypatch.setattr(steps, "build_regression", counted)
    estimate(
        rx60(), parse_terms("viscous_friction,coulomb_friction", rx60().joints), [prepare(log)]
    )
    # Where the search stands, while the next place is built.
    assert len(most) > 2 and max(most) == 1
