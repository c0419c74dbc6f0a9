"""Friction that rises more slowly the faster a joint turns, as measured strain-wave gears have it."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, NOISE, blank, log_with, small_arm

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare


@pytest.fixture(scope="module")
def concave():
    """The declared fit of a log whose first joint's lubricant yields: 8 tanh(dq / 0.6) N m beside the rest."""
    log = log_with(noise=replace(NOISE, torque=0.03))
    speed = np.gradient(log.q[:, 0], log.t)
    tau = log.tau.copy()
    tau[:, 0] += 8.0 * np.tanh(speed / 0.6)
    motion = prepare(replace(log, tau=tau), BAND)
    return with_motion_noise(estimate(small_arm(), blank(), [motion], bounded=False))


def power_law(found):
    (score,) = score_terms(
        Linearization(found, cross_fit(found)), [Term("nonlinear_viscous_friction", 0)], 0
    )
    return score


def test_the_exponent_stays_where_the_coefficient_is_positive(concave):
    """Beside a viscous term a concave curve fits on through alpha = 1, where c is negative."""
    score = power_law(concave)
    assert score.allowed and score.coefficients[0] > 0
    assert score.candidate.term.values["alpha"] < 1.0


def test_the_power_law_replaces_the_viscous_term_it_cannot_stand_beside(concave):
    after = refit_with(concave, power_law(concave))
    effects = [(t.effect, t.joint) for t in after.model.terms]
    assert ("nonlinear_viscous_friction", 0) in effects
    assert ("viscous_friction", 0) not in effects and ("viscous_friction", 1) in effects
    law = next(t for t in after.model.terms if t.effect == "nonlinear_viscous_friction")
    assert law.values["c"] > 0 and 0.2 < law.values["alpha"] < 1.0
    assert after.fit.sigma[0] < 0.5 * concave.fit.sigma[0]


def test_the_viscous_term_comes_back_beside_a_power_law_that_needs_it():
    """Fitted with both from afar the exponent runs past 1; without the viscous term it is 0.59."""
    log = log_with(noise=replace(NOISE, torque=0.001), motion_seed=9)
    speed = np.gradient(log.q[:, 0], log.t)
    tau = log.tau.copy()
    tau[:, 0] += 20.0 * np.sqrt(np.abs(speed)) * np.tanh(speed / 0.01)
    motion = prepare(replace(log, tau=tau), BAND)
    declared = with_motion_noise(estimate(small_arm(), blank(), [motion], bounded=False))
    after = refit_with(declared, power_law(declared))
    rows = zip(after.model.terms, after.std_errors, strict=True)
    own = {t.effect: (t.values, errors) for t, errors in rows if t.joint == 0}
    law, errors = own["nonlinear_viscous_friction"]
    assert abs(law["alpha"] - 0.5) < 4.0 * errors["alpha"] and errors["alpha"] < 0.01
    assert abs(own["viscous_friction"][0]["b"] - 3.0) < 0.1
