"""A log that begins in the middle of a link's swing: nobody measured the twist, and the fit does without."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline

from jaxswarm.diagnose.selection.elsewhere import errors_elsewhere, residuals_on, rms
from jaxswarm.effects.term import parse_terms
from jaxswarm.identify.estimation.estimate import estimate
from jaxswarm.identify.estimation.validate import log_errors
from jaxswarm.identify.forward.link_lag import unseen_start
from jaxswarm.identify.forward.seen import begun_before
from jaxswarm.identify.synthetic import fourier_motion
from jaxswarm.logs import log_from_arrays
from jaxswarm.logs.motion import Filtering, prepare
from jaxswarm.robot import robot_from_dh

INERTIA, STIFFNESS, DAMPING, VISCOUS, COULOMB = 2.0, 900.0, 9.0, 1.5, 2.0
RATE, SECONDS, TWIST = 250.0, 24.0, 0.03


def arm():
    return robot_from_dh("one", convention="modified", alpha=[0.0], a=[0.0], d=[0.0])


def recorded():
    """A motor that follows its path, and a link behind it that begins with a twist; an upright axis."""
    t, q, dq, _ = fourier_motion(1, np.random.default_rng(3), SECONDS, RATE)
    path = CubicHermiteSpline(t, q[:, 0], dq[:, 0])

    def rate(now, state):
        motor, speed = path(now), path(now, 1)
        return state[1], (STIFFNESS * (motor - state[0]) + DAMPING * (speed - state[1])) / INERTIA

    start = (q[0, 0] - TWIST, dq[0, 0])
    link, speed = solve_ivp(rate, (t[0], t[-1]), start, t_eval=t, max_step=4e-3, rtol=1e-8).y
    gear = STIFFNESS * (q[:, 0] - link) + DAMPING * (dq[:, 0] - speed)
    friction = VISCOUS * dq[:, 0] + COULOMB * np.tanh(dq[:, 0] / 0.01)
    noise = 0.02 * np.random.default_rng(4).standard_normal(len(t))
    tau = (gear + friction + noise)[:, None]
    return log_from_arrays(t, q, tau, dq=dq, joints=("joint1",))


@pytest.fixture(scope="module")
def motion():
    return prepare(recorded(), Filtering(30.0, 15.0))


def fitted(motion, effects):
    terms = parse_terms(effects, ("joint1",))
    near = {"k": 700.0, "d": 6.0}
    terms = tuple(replace(t, values=near) if "k" in t.law.nominal() else t for t in terms)
    return estimate(arm(), terms, [motion])


@pytest.fixture(scope="module")
def found(motion):
    return fitted(motion, "viscous_friction,coulomb_friction,joint_elasticity")


def test_a_log_that_begins_in_mid_swing_tells_the_spring(found):
    # Begun in equilibrium at the first sample it is told 22 % too soft, and leaves 0.64 N m. The swing that is
    # left after two seconds, a hundredth of it, still shows in the damping.
    assert abs(found.model.terms[-1].values["k"] / STIFFNESS - 1.0) < 0.04
    assert found.fit.sigma[0] < 0.03


def test_a_swing_that_nobody_saw_begin_is_not_scored(found, motion):
    """As another log, it counts from where the link is calm."""
    scored, whole = log_errors(found.model, motion), log_errors(found.model, motion, terms=())
    assert scored["left_out_s"] == 2.0 and whole["left_out_s"] == 0.0
    assert scored["rms"][0] < 0.03 and scored["wideband"]["rms"][0] < 0.05
    assert whole["rms"][0] > 10.0 * scored["rms"][0]
    (note,) = begun_before(found.model, [motion])
    assert "first 2 s" in note and "at rest" in note
    rigid = replace(found.model, terms=found.model.terms[:-1])
    assert not begun_before(rigid, [motion])


def test_two_models_are_compared_where_neither_link_swings_unseen(found, motion):
    """Over all rows the swing hides that the spring is what was missing."""
    rigid = fitted(motion, "viscous_friction,coulomb_friction")
    one, two, moving = residuals_on(rigid, found, motion)
    assert len(one) == len(two) == len(moving) < len(residuals_on(rigid, rigid, motion)[0])
    assert rms(two)[0] < 0.3 * rms(one)[0]
    ((before, after, falls, rises, _),) = errors_elsewhere(rigid, found, [motion])
    assert before[0] == rms(one)[0] and after[0] == rms(two)[0]
    assert falls[0] and not rises[0]


def test_only_a_log_that_begins_in_motion_is_doubted():
    log = recorded()
    assert unseen_start(prepare(log, Filtering(30.0, 15.0))) == 2.0
    t = np.concatenate([log.t, log.t[-1] + 1.0 / RATE + log.t[:250]])
    ahead = np.repeat(log.q[:1], 250, axis=0)
    q, none = np.concatenate([ahead, log.q]), np.zeros((250, 1))
    still = log_from_arrays(t, q, q, dq=np.concatenate([none, log.dq]), joints=("joint1",))
    assert unseen_start(prepare(still, Filtering(30.0, 15.0))) == 0.0
