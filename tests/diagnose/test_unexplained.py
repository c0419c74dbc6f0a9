"""Structure outside the catalog: found, with the variables it depends on; none in white noise."""

from dataclasses import replace

import numpy as np
import pytest
from planted import added, declared_fit, diagnose_log, log_with

from jaxswarm.diagnose.decision.smooth_rows import residual_variables
from jaxswarm.diagnose.decision.unexplained import find_unexplained, with_smooth_terms
from jaxswarm.diagnose.folds.joint_rows import RIDGES, JointRows
from jaxswarm.effects.term import Term
from jaxswarm.identify import load_model, model_torque, save_model
from jaxswarm.logs.motion import prepare

WIDTH = 0.01


def with_extra(shape, **options):
    """A log with a further torque ``shape(q, dq)`` on joint 2, from nearly exact positions."""
    log = log_with(**options)
    dq = np.gradient(log.q, log.t, axis=0)
    extra = np.zeros_like(log.tau)
    extra[:, 1] = shape(log.q, dq)
    return replace(log, tau=log.tau + extra)


LAWS = [
    ("q_joint2", lambda q, dq: 2.0 * np.sin(4 * q[:, 1] * dq[:, 1])),
    ("q_joint1", lambda q, dq: 2.0 * np.sin(2 * q[:, 0]) * np.tanh(dq[:, 1] / 0.05)),
]


@pytest.mark.parametrize(("other", "law"), LAWS)
def test_law_outside_the_catalog_is_unexplained_with_its_variables(other, law):
    found = diagnose_log(with_extra(law))
    left = [u for u in find_unexplained(found.final, found.crossfit) if u.joint == 1]
    assert added(found) == []
    assert set(left[0].depends_on) == {other, "dq_joint2"}
    assert left[0].share > 0.3 and left[0].p_value < 1e-3
    assert left[0].variables.shape == (len(left[0].smooth), 2)


@pytest.mark.parametrize("law", [lambda x: 4.0 * x * np.abs(x), lambda x: 3.0 * np.tanh(x / 0.3)])
def test_friction_by_the_load_in_a_form_that_nobody_knows_names_the_load(law):
    log = log_with(duration=30.0)
    known = Term("load_dependent_friction", 1, values={"mu": 0.1, "inertial": 1.0})
    extra = np.zeros_like(log.tau)
    extra[:, 1] = law(log_with(known, duration=30.0).tau[:, 1] - log.tau[:, 1])
    left = find_unexplained(*declared_fit(replace(log, tau=log.tau + extra)))
    assert [(u.joint, set(u.depends_on)) for u in left] == [(1, {"dq_joint2", "load_joint2"})]
    # A load depends on the model: the smooth function is told, and is no part of it.
    assert left[0].share > 0.8 and left[0].term is None


@pytest.mark.parametrize(("size", "least"), [(0.2, 0.9), (0.07, 0.7)])
def test_what_sits_at_one_place_is_a_function_of_the_position(size, least):
    """A magnet, of which functions as wide as the motion follow a part; a small one was told as a ripple."""

    def magnet(q, dq):
        x = (q[:, 1] - 0.2) / size
        return 4.0 * x * np.exp(-(x**2))

    found = diagnose_log(with_extra(magnet))
    (left,) = [u for u in find_unexplained(found.final, found.crossfit) if u.joint == 1]
    assert added(found) == []
    assert left.depends_on == ("q_joint2",)
    assert left.share > least


def test_the_smooth_term_lowers_the_residual():
    found, crossfit = declared_fit(with_extra(LAWS[0][1]))
    left = [u for u in find_unexplained(found, crossfit) if u.joint == 1][0]
    residual = found.fit.residual[:, 1]
    assert np.std(residual - left.smooth) < 0.85 * np.std(residual)


def test_a_smooth_term_predicts_another_log(tmp_path):
    law = LAWS[0][1]
    found, crossfit = declared_fit(with_extra(law))
    left = [u for u in find_unexplained(found, crossfit) if u.joint == 1]
    save_model(with_smooth_terms(found, left), tmp_path / "model.json")
    model = load_model(tmp_path / "model.json")
    other = with_extra(law, motion_seed=8)
    motion = prepare(other, model.filtering)

    def error(one):
        return np.std((model_torque(one, motion) - motion.tau)[:, 1])

    assert error(model) < 0.8 * error(found.model)


def test_a_smooth_term_stays_at_the_edge_of_its_range():
    found, crossfit = declared_fit(with_extra(LAWS[0][1]))
    term = find_unexplained(found, crossfit)[0].term
    motion = found.motions[0]
    edge = np.array(motion.q)
    edge[:, 1] = term.upper[term.inputs.index(("q", 1))]
    at_edge = term.torque(replace(motion, q=edge))
    np.testing.assert_array_equal(term.torque(replace(motion, q=edge + 5.0)), at_edge)


def test_structure_over_time_is_shown_but_not_put_into_the_model():
    log = log_with()
    extra = np.zeros_like(log.tau)
    extra[:, 1] = 3.0 * np.sin(0.9 * log.t)
    found, crossfit = declared_fit(replace(log, tau=log.tau + extra))
    left = [u for u in find_unexplained(found, crossfit) if "t" in u.depends_on]
    assert left and left[0].term is None
    model = with_smooth_terms(found, left)
    assert model.smooth == ()
    np.testing.assert_array_equal(model.robot.parameters, found.model.robot.parameters)


def left_with(shape, duration: float, motion_seed: int):
    """What is left on joint 2 of a log with a further torque ``shape(q, t)``."""
    log = log_with(duration=duration, motion_seed=motion_seed)
    extra = np.zeros_like(log.tau)
    extra[:, 1] = shape(log.q, log.t)
    (left,) = find_unexplained(*declared_fit(replace(log, tau=log.tau + extra)), joints=[1])
    return left


def test_states_that_go_along_with_time_in_slow_motion_stand_beside_it():
    """Of this motion of 8 s a smooth function of time explains more than one of the states of the law."""
    left = left_with(lambda q, t: 3.0 * q[:, 0] ** 2 * q[:, 1], 8.0, 9)
    assert left.depends_on == ("q_joint1", "t")
    names, share = left.or_states
    assert set(names) == {"q_joint1", "q_joint2"}
    assert 0.9 < share < left.share


def test_a_drift_is_told_by_time_alone():
    assert left_with(lambda q, t: 0.2 * t, 20.0, 7).or_states is None
    faint = left_with(lambda q, t: 0.05 * np.sin(0.5 * t), 20.0, 7)
    assert faint.depends_on == ("t",) and faint.or_states is None
    assert faint.share < 0.5


def test_white_residual_has_no_structure():
    found, crossfit = declared_fit(log_with())
    assert find_unexplained(found, crossfit) == []


def test_variables_are_named_and_sampled_like_the_residual():
    found, _ = declared_fit(log_with())
    table = residual_variables(found)
    wanted = {f"{s}_joint{j}" for s in ("q", "dq", "ddq") for j in (1, 2)} | {"t"}
    assert set(table) == wanted
    assert all(x.shape == (len(found.regression.t),) for x in table.values())


@pytest.mark.parametrize("ridge", RIDGES)
def test_a_ridge_loses_no_digits_to_its_squares(ridge):
    """Columns that nearly depend on each other: the ridge bounds the condition of their squares themselves."""
    rng = np.random.default_rng(0)
    free = rng.normal(size=(400, 20))
    free[:, 10:] = free[:, :10] + 1e-6 * rng.normal(size=(400, 10))
    residual = rng.normal(size=400)
    held = np.sqrt(ridge * (free**2).sum() / free.shape[1])
    rows = np.concatenate([free, held * np.eye(20)])
    exact = np.linalg.lstsq(rows, np.append(residual, np.zeros(20)), rcond=None)[0]
    nothing, none = np.zeros((len(free), 0)), np.zeros(0)
    train = np.ones(len(free), bool)
    rows = JointRows(train, nothing, nothing[:0], residual, none, np.zeros((0, 0)), none)
    np.testing.assert_allclose(rows.coefficients(free, ridge)[0], exact, rtol=1e-10, atol=1e-14)


def test_a_joint_that_stands_all_the_time_has_structure_without_a_velocity():
    """Held by dry friction: its load varies with the other joints, its own state does not."""
    log = log_with(duration=30.0)
    q = log.q.copy()
    q[:, 1] = 0.3
    tau = log.tau.copy()
    tau[:, 1] = 3.0 * np.sin(2.0 * q[:, 0]) + 0.01 * np.random.default_rng(0).normal(size=len(q))
    found, crossfit = declared_fit(replace(log, q=q, dq=None, tau=tau))
    left = [u for u in find_unexplained(found, crossfit) if u.joint == 1]
    assert all("dq_joint2" not in u.depends_on for u in left)
