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
