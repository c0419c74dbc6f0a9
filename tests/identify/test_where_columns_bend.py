"""Where columns depend on the parameters and a fit ends early, these are the ones it stands at."""

import numpy as np
import pytest
from small_problems import make_motion, planar_arm

from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.estimation import gauss_newton
from jaxswarm.identify.estimation.free_parameters import Place
from jaxswarm.identify.estimation.gauss_newton import settle
from jaxswarm.identify.estimation.problem import Problem
from jaxswarm.identify.forward.columns import rigid_of
from jaxswarm.identify.forward.model import linear_values, model_torque

ARM = planar_arm()
PI = np.asarray(ARM.parameters).ravel()
WIDTH = (0.05, 0.05)
TERMS = (
    Term("coulomb_friction", 0, values={"fc": 0.5}),
    Term("rotor_inertia", 1, values={"ia": 0.1}),
    Term("joint_elasticity", 1, values={"k": 60.0, "d": 0.5}),
)


@pytest.fixture
def motion():
    rng = np.random.default_rng(0)
    return make_motion(
        ARM,
        lambda q, dq, ddq: 0.5 * np.tanh(dq / 0.05) + 0.01 * rng.normal(size=dq.shape),
        length=800,
    )


def test_what_is_left_is_left_by_the_parameters_that_are_told(motion, monkeypatch):
    """A link's inertia was that of one step and its rotor's that of the next: together half the true one."""
    monkeypatch.setattr(gauss_newton, "_ROUNDS", 1)
    found = estimate(ARM, TERMS, [motion], width=WIDTH, start=0.3 * PI)
    left = motion.decimator.apply(motion.tau - model_torque(found.model, motion))
    used = found.regression.used_rows
    np.testing.assert_allclose(found.fit.residual[used], left[used], rtol=1e-6, atol=1e-9)
    own = found.fit.base.reduce(linear_values(found.model))
    np.testing.assert_allclose(found.fit.values, own, rtol=1e-9, atol=1e-12)


def test_where_no_step_leaves_less_nothing_moves(motion, monkeypatch):
    monkeypatch.setattr(gauss_newton, "_cost_of", lambda left, sigma: np.inf)
    problem = Problem(ARM, (motion,), (rigid_of(ARM, motion),), False)
    start = np.concatenate([0.3 * PI, [0.2, 0.05]])
    here = settle(problem, Place(TERMS, WIDTH), start)
    np.testing.assert_array_equal(here.theta, start)
    np.testing.assert_array_equal(here.pi, 0.3 * PI)
    left = problem.left(here.regression, here.place, here.theta)
    np.testing.assert_allclose(here.residual, left, rtol=1e-6, atol=1e-9)
    assert not np.allclose(here.solution.theta, start)


def test_a_model_near_by_is_gone_on_from(motion):
    """From its rigid parameters alone the others are those of the first step."""
    problem = Problem(ARM, (motion,), (rigid_of(ARM, motion),), False)
    place = Place(TERMS, WIDTH)
    found = settle(problem, place, settle(problem, place, PI).theta)
    again = settle(problem, place, found.theta)
    np.testing.assert_allclose(again.residual, found.residual, atol=1e-6)
