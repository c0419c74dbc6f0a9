"""Logs that cannot be fitted are refused by name, and a model that runs away is no number."""

from dataclasses import replace

import jax
import numpy as np
import pytest
from small_problems import make_motion, planar_arm

from jaxswarm.effects.term import Term
from jaxswarm.errors import InputError
from jaxswarm.identify import estimate
from jaxswarm.identify.forward.finite_columns import Diverged
from jaxswarm.identify.forward.regression import build_regression
from jaxswarm.identify.report.summary import term_parameters

FRICTION = (Term("viscous_friction", 0), Term("coulomb_friction", 0), Term("coulomb_friction", 1))


@pytest.fixture(scope="module")
def motion():
    return make_motion(planar_arm(), lambda q, dq, ddq: 0.3 * dq, noise=0.01)


def test_a_dead_torque_channel_is_refused_with_its_joint(motion):
    tau = motion.tau.copy()
    tau[:, 1] = 0.0
    with pytest.raises(InputError, match="torque of joint2 is 0 in every sample"):
        estimate(planar_arm(), FRICTION, [replace(motion, tau=tau)])
    # Another log in which it lives may decide.
    estimate(planar_arm(), FRICTION, [motion, replace(motion, tau=tau)])


def test_a_law_without_its_channel_is_refused(motion):
    heated = (*FRICTION, Term("temperature_friction", 1))
    with pytest.raises(InputError, match="temperature_friction@joint2 needs .*temperature_joint2"):
        estimate(planar_arm(), heated, [motion])
    channel = np.full(motion.q.shape, np.nan)
    with pytest.raises(InputError, match="temperature_joint2"):
        estimate(planar_arm(), heated, [replace(motion, channels={"temperature": channel})])
    rising = np.linspace(20.0, 40.0, len(motion.t))[:, None] * np.ones(2)
    warm = estimate(planar_arm(), heated, [replace(motion, channels={"temperature": rising})])
    assert np.isfinite(warm.fit.values).all()


def test_velocities_of_zero_are_refused(motion):
    with pytest.raises(InputError, match="every velocity is zero"):
        estimate(planar_arm(), FRICTION, [replace(motion, dq=np.zeros_like(motion.dq))])


def test_single_precision_is_refused_and_a_scope_of_doubles_is_enough(motion):
    jax.config.update("jax_enable_x64", False)
    try:
        with pytest.raises(InputError, match="jax_enable_x64"):
            estimate(planar_arm(), FRICTION, [motion])
        with jax.enable_x64(True):
            within = estimate(planar_arm(), FRICTION, [motion])
    finally:
        jax.config.update("jax_enable_x64", True)
    assert within.fit.base.size == estimate(planar_arm(), FRICTION, [motion]).fit.base.size


def test_a_link_that_runs_away_is_named_and_no_column_is_nan(motion):
    soft = Term("joint_elasticity", 1, values={"k": 10.0, "d": 0.01})
    upside_down = -1e5 * np.asarray(planar_arm().parameters).ravel()
    with pytest.raises(Diverged, match="joint_elasticity@joint2"):
        build_regression(planar_arm(), (soft,), [motion], (0.01, 0.01), upside_down)


def test_a_fit_turns_away_from_places_where_the_link_runs_away(motion, monkeypatch):
    """Beyond a stiffness the model is not finite: the fit ends before it instead of failing."""
    from jaxswarm.identify.estimation import problem

    build = problem.build_regression
    refused = []

    def limited(robot, terms, *rest, **how):
        if terms[-1].values["k"] > 1.2e4:
            refused.append(terms[-1].values["k"])
            raise Diverged("too stiff")
        return build(robot, terms, *rest, **how)

    monkeypatch.setattr(problem, "build_regression", limited)
    soft = Term("joint_elasticity", 1, values={"k": 1e4, "d": 5.0})
    found = estimate(planar_arm(), (*FRICTION, soft), [motion])
    assert refused and found.model.terms[-1].values["k"] <= 1.2e4


def test_a_spring_without_stiffness_has_no_position_of_rest():
    slack = Term("joint_spring", 0, values={"k": 0.0, "tau0": 0.3})
    assert set(term_parameters(slack, planar_arm())) == {"k", "tau0"}
    tight = term_parameters(Term("joint_spring", 0, values={"k": 2.0, "tau0": 3.0}), planar_arm())
    assert tight["q0"]["value"] == -1.5
