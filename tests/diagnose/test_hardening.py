"""A spring that hardens is told from a straight one and from a dead zone, which it replaces."""

from functools import cache

import jax.numpy as jnp
import numpy as np
import pytest
from elbow import ASKED
from planted import BAND
from scipy.integrate import solve_ivp

from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.worth import passes
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.extended import extended
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.effects.deflection import deflection
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import robot_from_dh
from jaxswarm.simulate import make_plant, rest, simulate, stable_substeps

K, EH, D = 5000.0, 0.008, 12.0
INERTIA, WEIGHT, ROTOR, FRICTION = 1.2, 45.0, 0.6, 4.0
RATE, LENGTH, NOISE = 250.0, 20.0, 0.15
REPLACED = ("joint_elasticity", "backlash")
DECLARED = "viscous_friction,coulomb_friction,rotor_inertia"
PENDULUM = robot_from_dh(
    "pendulum", convention="modified", alpha=[np.pi / 2], a=[0.0], d=[0.0]
).replace(parameters=np.array([[10.0, WEIGHT / 9.81, 0, 0, 0.1, 0, INERTIA, 0, 0, INERTIA]]))
# Amplitudes [rad] and frequencies [Hz] of the motor's motion.
WAVES = ((0.9, 0.21, 0.3), (0.35, 0.83, 1.1), (0.06, 2.3, 2.0), (0.012, 4.1, 0.4))


def motor(t, order=0):
    """Position of the motor, or a derivative."""
    return sum(
        a * (2 * np.pi * f) ** order * np.sin(2 * np.pi * f * t + p + order * np.pi / 2)
        for a, f, p in WAVES
    )


def pushed(e, hard: bool):
    return K * e * (1.0 + (e / EH) ** 2 if hard else 1.0)


def link(t, hard: bool):
    """Lag of the link behind the motor and its rate, integrated by SciPy."""

    def rate(now, state):
        q, v = state
        e, de = motor(now) - q, motor(now, 1) - v
        return v, (pushed(e, hard) + D * de - WEIGHT * np.cos(q)) / INERTIA

    begin = (motor(-2.0), motor(-2.0, 1))
    path = solve_ivp(rate, (-2.0, t[-1]), begin, t_eval=t, max_step=2e-3, rtol=1e-8, atol=1e-10)
    return motor(t) - path.y[0], motor(t, 1) - path.y[1]


def soft_log(hard: bool) -> Log:
    t = np.arange(0.0, LENGTH, 1.0 / RATE)
    e, de = link(t, hard)
    rng = np.random.default_rng(2)
    tau = ROTOR * motor(t, 2) + pushed(e, hard) + D * de
    tau += FRICTION * (np.tanh(motor(t, 1) / 0.01) + 0.5 * motor(t, 1))
    q = motor(t) + 1e-5 * rng.normal(size=len(t))
    tau += NOISE * rng.normal(size=len(t))
    return Log("pendulum", PENDULUM.joints, t, q[:, None], tau=tau[:, None])


def asked(found, *effects):
    terms = [t for t in eligible_terms(found.model, found.motions) if t.effect in effects]
    scores = score_terms(Linearization(found, cross_fit(found)), terms, 0)
    return [s for s in sorted(scores, key=lambda s: -s.gain) if passes(s, ASKED, Rules())]


@cache
def declared_alone(hard: bool):
    declared = parse_terms(DECLARED, PENDULUM.joints)
    return estimate(PENDULUM, declared, [prepare(soft_log(hard), BAND)], bounded=False)


def with_first(hard: bool, first: str):
    """The fit with what was found first in place of the spring."""
    found = declared_alone(hard)
    assert "hardening_elasticity" not in {
        t.effect for t in eligible_terms(found.model, found.motions)
    }
    return refit_with(found, asked(found, first)[0])


def test_a_dead_zone_is_not_what_a_spring_that_hardens_is_told_as_first():
    found = declared_alone(True)
    assert asked(found, *REPLACED)[0].candidate.term.effect == "joint_elasticity"


def test_a_spring_that_hardens_is_named_with_its_values():
    before = with_first(True, "joint_elasticity")
    best = asked(before, "hardening_elasticity", "hysteresis", "torque_dead_band")[0]
    after = refit_with(before, best)
    term = find_term(after, best.candidate.term)
    assert term.effect == "hardening_elasticity"
    assert not [t for t in after.model.terms if t.effect in REPLACED]
    for name, value in {"k": K, "eh": EH, "d": D}.items():
        assert term.values[name] == pytest.approx(value, rel=0.1), name


def test_a_straight_spring_stays_what_it_is():
    assert not asked(with_first(False, "joint_elasticity"), "hardening_elasticity")


@pytest.mark.parametrize("hard", [True, False], ids=["hardens", "is straight"])
def test_a_spring_is_judged_by_the_fit_of_one_that_hardens(hard):
    """Where an encoder's error is told in the place of either, and the other one is not asked beside it."""
    found = declared_alone(hard)
    (straight,) = asked(found, "joint_elasticity")
    further = extended(straight, refit_with(found, straight), 0)
    if not hard:
        assert further is None
        return
    score, after = further
    term = find_term(after, score.candidate.term)
    assert (term.effect, score.candidate.size) == ("hardening_elasticity", 3)
    assert score.gain == straight.gain
    assert term.values["k"] == pytest.approx(K, rel=0.1)


def test_a_motor_on_a_spring_that_hardens_settles_where_it_holds_the_weight():
    values = {"k": K, "eh": EH, "d": 10.0 * D}
    held = (
        Term("hardening_elasticity", 0, values=values),
        Term("rotor_inertia", 0, values={"ia": 5.0}),
        Term("viscous_friction", 0, values={"b": 60.0}),
    )
    plant = make_plant(PENDULUM, held)
    steady = jnp.full((3000, 1), 0.5 * WEIGHT)
    start = rest(plant, jnp.full(1, -np.pi / 3))
    end = simulate(
        plant, start, steady, dt=1e-3, substeps=stable_substeps(plant, jnp.zeros(1), 1e-3)
    )
    twist = float(end.q[-1, 0] - end.q_link[-1, 0])
    assert pushed(twist, True) == pytest.approx(0.5 * WEIGHT, rel=1e-3)
    assert twist < 0.9 * 0.5 * WEIGHT / K


def test_the_lag_on_a_spring_that_hardens_is_what_scipy_integrates():
    t = np.arange(0.0, 4.0, 1.0 / RATE)
    drive = 60.0 * np.cos(2 * np.pi * 0.8 * t) + 20.0 * np.sin(2 * np.pi * 2.1 * t)

    def rate(now, state):
        e, v = state
        torque = 60.0 * np.cos(2 * np.pi * 0.8 * now) + 20.0 * np.sin(2 * np.pi * 2.1 * now)
        return v, (torque - pushed(e, True) - D * v) / INERTIA

    shape = np.ones_like(t)
    held = (INERTIA * shape, 0.0 * shape, 0.0 * shape, drive)
    told, _, _ = deflection(*held, K, D, 0.0, K / EH**2, 1.0 / RATE)
    assert pushed(told[0], True) == pytest.approx(drive[0], rel=0.1)
    start = (float(told[0]), 0.0)
    true = solve_ivp(rate, (0.0, t[-1]), start, t_eval=t, max_step=5e-4, rtol=1e-9).y[0]
    np.testing.assert_allclose(told, true, atol=0.02 * np.abs(true).max())
    assert np.abs(true).max() > 0.8 * EH
