"""Simulated logs give back what made them: linear and load-dependent laws, weights, held-out error."""

import numpy as np
import pytest
from small_problems import make_motion, planar_arm

from jaxswarm.errors import InputError
from jaxswarm.identify import estimate, model_torque, parse_terms
from jaxswarm.identify.estimation import gauss_newton, least_squares
from jaxswarm.identify.estimation.validate import (
    held_out_errors,
    held_out_residual,
    log_errors,
    time_blocks,
)
from jaxswarm.identify.forward.metrics import is_moving, torque_errors
from jaxswarm.identify.report.summary import base_parameter_table, correlation, unidentified

EFFECTS = "viscous_friction,coulomb_friction@joint1,torque_offset@joint2"
B, FC, OFFSET, WIDTH = np.array([0.8, 0.3]), 0.6, -0.4, 0.05


def friction(q, dq, ddq):
    out = B * dq
    out[:, 0] += FC * np.tanh(dq[:, 0] / WIDTH)
    out[:, 1] += OFFSET
    return out


@pytest.fixture(scope="module")
def arm():
    return planar_arm()


@pytest.fixture(scope="module")
def found(arm):
    motion = make_motion(arm, friction, noise=0.02)
    return estimate(arm, parse_terms(EFFECTS, arm.joints), [motion])


def test_exact_data_give_the_exact_model(arm):
    motion = make_motion(arm, friction)
    exact = estimate(arm, parse_terms(EFFECTS, arm.joints), [motion], width=WIDTH)
    values = [t.values for t in exact.model.terms]
    assert [v["b"] for v in values[:2]] == pytest.approx(list(B), rel=1e-7)
    assert values[2]["fc"] == pytest.approx(FC, rel=1e-7)
    assert values[3]["tau0"] == pytest.approx(OFFSET, rel=1e-7)
    np.testing.assert_allclose(model_torque(exact.model, motion), motion.tau, atol=1e-7)
    base = exact.fit.base
    truth = np.concatenate([np.asarray(arm.parameters).ravel(), B, [FC, OFFSET]])
    np.testing.assert_allclose(exact.fit.values, base.reduce(truth), atol=1e-7)


def test_width_and_parameters_are_found_under_noise(found):
    assert found.model.width == pytest.approx((WIDTH,) * len(found.model.width), rel=0.5)
    for term, errors, true in zip(
        found.model.terms, found.std_errors, (B[0], B[1], FC, OFFSET), strict=True
    ):
        name = term.law.linear[0].name
        assert abs(term.values[name] - true) < 5 * errors[name] + 1e-3
    assert found.fit.sigma == pytest.approx([0.02, 0.02], rel=0.15)


def test_how_certain_a_fit_is_is_asked_of_the_last_step_alone(arm, monkeypatch):
    asked = {"steps": 0, "doubts": 0}

    def counted(name, function):
        def call(*args, **more):
            asked[name] += 1
            return function(*args, **more)

        return call

    monkeypatch.setattr(gauss_newton, "settle", counted("steps", gauss_newton.settle))
    monkeypatch.setattr(least_squares, "scored", counted("doubts", least_squares.scored))
    motion = make_motion(arm, friction, noise=0.02)
    terms = parse_terms(EFFECTS + ",stribeck_friction@joint1", arm.joints)
    estimate(arm, terms, [motion], width=4 * WIDTH, refine_width=True)
    # Once of the linear parameters, once of all together, at most three times of what each width would be.
    assert asked["doubts"] <= 5 < asked["steps"]


def test_the_model_predicts_another_motion(found, arm):
    other = make_motion(arm, friction, seed=5)
    errors = log_errors(found.model, other)
    assert errors["relative_global"] < 0.01
    assert errors["wideband"]["relative_global"] == pytest.approx(errors["relative_global"])


def test_friction_below_zero_is_held_at_its_bound(arm):
    motion = make_motion(arm, lambda q, dq, ddq: -0.2 * dq, noise=0.01)
    held = estimate(arm, parse_terms("viscous_friction", arm.joints), [motion], width=WIDTH)
    assert [t.values["b"] for t in held.model.terms] == [0.0, 0.0]
    verdicts = {row["name"]: row["verdict"] for row in base_parameter_table(held)}
    assert verdicts["b_joint1"] == verdicts["b_joint2"] == "at bound"
    free = estimate(
        arm, parse_terms("viscous_friction", arm.joints), [motion], width=WIDTH, bounded=False
    )
    assert [t.values["b"] for t in free.model.terms] == pytest.approx([-0.2, -0.2], abs=0.01)


def test_a_sum_of_inertias_below_zero_is_not_called_determined(arm):
    """By so much that no inertia of the arm makes up for it, and by so little that noise does."""

    def lacking(size):
        motion = make_motion(arm, lambda q, dq, ddq: -size * ddq * [1.0, 0.0], noise=0.01)
        return estimate(arm, (), [motion], width=WIDTH)

    def row(found):
        return next(row for row in base_parameter_table(found) if row["name"] == "Izz1")

    own = row(lacking(0.0))
    assert own["verdict"] == "determined" and "-" not in own["expression"]
    below = row(lacking(own["value"] + 10.0 * own["std_error"]))
    assert below["value"] < 0.0 and below["verdict"] == "impossible"
    near = row(lacking(own["value"] + 0.5 * own["std_error"]))
    assert near["value"] < 0.0 and near["verdict"] == "weak"


def test_what_is_worth_nothing_is_negligible_and_not_determined(arm):
    """A mass moment that is there by noise alone, beside those that make the torque."""
    motion = make_motion(arm, friction, noise=0.02)
    found = estimate(
        arm, parse_terms(f"{EFFECTS},torque_offset@joint1", arm.joints), [motion], width=WIDTH
    )
    rows = {row["name"]: row for row in base_parameter_table(found)}
    none = rows["tau0_joint1"]  # the arm of the log has no offset
    assert abs(none["value"]) < 3.0 * none["std_error"]
    assert none["verdict"] == "negligible" and none["relative_error"] > 0.1
    assert all(r["verdict"] == "determined" for r in rows.values() if r["relative_error"] <= 0.1)


def test_several_logs_fit_together(arm):
    motions = [make_motion(arm, friction, length=300, noise=0.02, seed=s) for s in (1, 2)]
    both = estimate(arm, parse_terms(EFFECTS, arm.joints), motions, width=WIDTH)
    assert set(both.regression.log) == {0, 1}
    assert both.model.terms[0].values["b"] == pytest.approx(B[0], abs=0.02)


def test_summary_has_a_row_for_every_parameter(found):
    names = {row["name"] for row in base_parameter_table(found)}
    lost = {row["name"].split(":")[0] for row in unidentified(found)}
    assert len(names) == found.fit.base.size
    assert len(names) + len(lost) == 20 + 4
    assert {row["verdict"] for row in base_parameter_table(found)} <= {
        "determined", "negligible", "weak", "impossible", "at bound",
    }  # fmt: skip
    matrix = correlation(found)
    np.testing.assert_allclose(np.diag(matrix), 1.0)
    assert np.abs(matrix).max() <= 1.0 + 1e-9


def test_held_out_errors_exceed_fitted_ones_a_little(found):
    fitted = np.linalg.norm(found.fit.residual)
    unseen = np.linalg.norm(held_out_residual(found, 4))
    assert fitted < unseen < 1.3 * fitted
    assert held_out_errors(found, 4)["relative_global"] == pytest.approx(
        unseen / np.linalg.norm(found.regression.torque)
    )


def test_held_out_blocks_are_not_seen(found):
    # Breaking one block changes its own residual only by the break.
    block = time_blocks(found.regression.log, 4) == 2
    torque = found.regression.torque.copy()
    torque[block] += 5.0
    from dataclasses import replace

    broken = replace(found, regression=replace(found.regression, torque=torque))
    difference = held_out_residual(broken, 4) - held_out_residual(found, 4)
    np.testing.assert_allclose(difference[block], 5.0, atol=1e-9)


def test_too_few_samples_and_no_torque_are_refused(arm):
    from dataclasses import replace

    short = make_motion(arm, length=8)
    with pytest.raises(InputError, match="fewer than"):
        estimate(arm, parse_terms("none", arm.joints), [short], width=WIDTH)
    with pytest.raises(InputError, match="no torque"):
        estimate(arm, (), [replace(make_motion(arm), tau=None)], width=WIDTH)


def test_metrics_by_hand():
    measured = np.array([[1.0, 0.0], [3.0, 0.0], [2.0, 4.0]])
    predicted = np.array([[1.0, 0.0], [1.0, 0.0], [2.0, 1.0]])
    moving = np.array([[True, True], [False, True], [True, True]])
    e = torque_errors(measured, predicted, moving)
    assert e["rms"] == pytest.approx([np.sqrt(4 / 3), np.sqrt(3.0)])
    assert e["relative"] == pytest.approx([2 / np.sqrt(14), 3 / 4])
    assert e["rae"] == pytest.approx([2 / 2, 3 / (16 / 3)])
    assert e["rms_moving"] == pytest.approx([0.0, np.sqrt(3.0)])
    assert e["rms_standing"] == [2.0, None]
    assert e["relative_global"] == pytest.approx(np.sqrt(13 / 30))


def test_moving_means_a_share_of_the_top_speed():
    dq = np.array([[1.0, 0.0], [0.02, 0.0], [0.005, 0.0]])
    np.testing.assert_array_equal(is_moving(dq), [[True, False], [True, False], [False, False]])
    assert torque_errors(np.zeros((2, 1)), np.ones((2, 1)), np.ones((2, 1), bool))["relative"] == [
        np.inf
    ]
