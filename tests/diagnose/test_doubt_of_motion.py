"""The noise of encoders pulls a spring that is fitted to what they say, and its interval has room for that."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND
from test_hardening import (
    DECLARED,
    FRICTION,
    INERTIA,
    NOISE,
    PENDULUM,
    ROTOR,
    WEIGHT,
    D,
    K,
    motor,
    soft_log,
)

from jaxswarm.diagnose.decision.rules import MORE_THAN_NOISE
from jaxswarm.diagnose.selection.doubt_of_motion import fall_without_noise, with_doubt_of_motion
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

COARSE = 1e-4
SPRING = Term("joint_elasticity", 0, values={"k": K, "d": D})


def fitted(log, noise, *springs):
    """The model of a log with more noise on its positions."""
    q = log.q + noise * np.random.default_rng(0).normal(size=log.q.shape)
    terms = (*parse_terms(DECLARED, PENDULUM.joints), *springs)
    return estimate(PENDULUM, terms, [prepare(replace(log, q=q), BAND)], bounded=False)


def stiff_log():
    """The same motion and friction, the link on the motor's shaft."""
    log = soft_log(False)
    dq, ddq = (motor(log.t, order) for order in (1, 2))
    tau = (ROTOR + INERTIA) * ddq + WEIGHT * np.cos(motor(log.t))
    tau += FRICTION * (np.tanh(dq / 0.01) + 0.5 * dq)
    tau += NOISE * np.random.default_rng(2).normal(size=len(log.t))
    return replace(log, tau=tau[:, None])


@pytest.fixture(scope="module")
def found():
    """A soft gear behind an encoder with ten times the noise."""
    return fitted(soft_log(False), COARSE, SPRING)


def test_a_soft_joint_takes_off_as_much_without_the_noise(found):
    before = fitted(soft_log(False), COARSE)
    assert fall_without_noise(before, found, 0) == pytest.approx(1.0, abs=0.05)
    unknown = tuple(replace(m, position_noise=None) for m in found.motions)
    assert fall_without_noise(before, replace(found, motions=unknown), 0) == 1.0


def test_a_stiff_joint_takes_off_what_the_noise_makes_of_its_inertia():
    """One was told as soft behind positions with a noise of 4e-5 rad, at 0.9 times the noise of its torque."""
    before, after = (fitted(stiff_log(), 3.0 * COARSE, *spring) for spring in ((), (SPRING,)))
    assert (after.fit.residual**2).sum() < 0.95 * (before.fit.residual**2).sum()
    assert fall_without_noise(before, after, 0) < MORE_THAN_NOISE


def test_a_spring_is_within_its_interval_behind_a_coarse_encoder(found):
    wide = with_doubt_of_motion(found)
    off = {n: found.model.terms[-1].values[n] - true for n, true in {"k": K, "d": D}.items()}
    for name, error in off.items():
        assert abs(error) > 2.0 * found.std_errors[-1][name]
        assert abs(error) < 1.96 * wide.std_errors[-1][name]
    assert wide.std_errors[:-1] == found.std_errors[:-1]
    assert wide.model is found.model


def test_a_dead_zone_and_a_log_whose_noise_is_not_known_are_left_as_they_are(found):
    gap = Term("backlash", 0, values={"gap": 0.005, "flank": 30.0, "blur": 0.12})
    other = replace(found, model=replace(found.model, terms=(*found.model.terms[:-1], gap)))
    assert with_doubt_of_motion(other) is other
    unknown = tuple(replace(m, position_noise=None) for m in found.motions)
    blind = replace(found, motions=unknown)
    assert with_doubt_of_motion(blind) is blind
