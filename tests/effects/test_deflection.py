"""Where a link starts behind its motor: on the flank its load presses, whatever the first sample says."""

import jax
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import butter, sosfiltfilt

from jaxswarm.effects.deflection import deflection, substeps_of

RATE, INERTIA, STIFFNESS, DAMPING, GAP = 500.0, 40.0, 4e5, 4e3, 0.01


def lag(torque, gap=GAP):
    shape = np.ones(len(torque))
    held = (INERTIA * shape, 0.0 * shape, 0.0 * shape, torque)
    e, _, _ = deflection(*held, STIFFNESS, DAMPING, gap, 0.0, 1.0 / RATE)
    return np.asarray(e)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("wrong", [0.0, -1.0, -3.0])
def test_a_first_sample_of_the_wrong_sign_leaves_the_link_on_its_flank(side, wrong):
    torque = np.full(500, 60.0 * side)
    told = lag(torque)
    np.testing.assert_allclose(told, side * (GAP + 60.0 / STIFFNESS), rtol=1e-9)
    torque[0] *= wrong
    np.testing.assert_allclose(lag(torque), told, atol=0.2 * GAP)


def test_from_the_flank_it_goes_on_as_the_equation_of_the_link_says():
    t = np.arange(1000) / RATE
    torque = 60.0 * np.cos(2 * np.pi * 0.8 * t)

    def rate(now, state):
        e, v = state
        beyond = e - np.clip(e, -GAP, GAP)
        flank = STIFFNESS * beyond + (DAMPING * v if beyond else 0.0)
        return v, (60.0 * np.cos(2 * np.pi * 0.8 * now) - flank) / INERTIA

    start = (GAP + 60.0 / STIFFNESS, 0.0)
    true = solve_ivp(rate, (0.0, t[-1]), start, t_eval=t, max_step=2e-4, rtol=1e-8).y[0]
    assert true.min() < -GAP  # it falls through, and back
    np.testing.assert_allclose(lag(torque), true, atol=0.05 * GAP)


def test_what_a_filter_leaves_of_an_impact_does_not_hang_on_when_samples_see_it():
    """Its force lasts a few milliseconds, a sample or two; below the rate it is its impulse."""

    def low(rate):
        t = np.arange(6.0 * rate) / rate
        shape, wave = np.ones(len(t)), 2 * np.pi * 60.0
        gear = INERTIA * wave**2, 0.6 * INERTIA * wave, GAP
        held = (INERTIA * shape, 0.0 * shape, 0.0 * shape, 60.0 * np.cos(2 * np.pi * 0.8 * t))
        _, _, a = deflection(*held, *gear, 0.0, 1.0 / rate)
        return sosfiltfilt(butter(4, 12.0, fs=rate, output="sos"), np.asarray(a))

    seldom, often = low(500.0)[400:-400], low(4000.0)[::8][400:-400]
    assert np.abs(seldom - often).max() < 0.05 * np.abs(often).max()


def test_accelerations_of_a_smooth_lag_are_those_at_the_samples():
    t = np.arange(1000) / RATE
    shape, wave = np.ones(len(t)), 2.0 * np.pi * 0.1 * RATE
    torque = 60.0 * np.cos(wave * t)
    held = (shape, 0.0 * shape, 0.0 * shape, torque)
    e, _, a = map(np.asarray, deflection(*held, STIFFNESS, 200.0, 0.0, 0.0, 1.0 / RATE))
    late = slice(100, -100)
    expected = -(wave**2) * e[late]  # it swings as its torque does, at a tenth of the rate
    assert np.abs(a[late] - expected).max() < 0.02 * np.abs(expected).max()


@pytest.mark.parametrize("wrong", [1.0, -3.0])
def test_a_spring_starts_in_the_equilibrium_of_its_first_torques_whatever_the_first_sample_says(
    wrong,
):
    torque = np.linspace(-30.0, -28.0, 500)
    torque[0] *= wrong
    assert lag(torque, gap=0.0)[0] == pytest.approx(-29.75 / STIFFNESS, rel=0.15)


def test_a_link_whose_start_was_not_seen_settles_where_its_torque_would_hold_it():
    t = np.arange(2000) / RATE
    slow, n = 60.0 * np.cos(2 * np.pi * 0.8 * t), 250
    shape, zero = np.ones(len(t)), np.zeros(len(t))
    jolt = slow + np.where(t < 0.1, 400.0, 0.0)  # what the first samples say besides

    def along(torque, calm):
        held = (INERTIA * shape, zero, zero, torque)
        return np.asarray(deflection(*held, STIFFNESS, 20.0, 0.0, 0.0, 1.0 / RATE, calm)[0])

    steady = slow / STIFFNESS
    assert np.abs(along(jolt, 0) - steady)[n:].max() > np.abs(steady).max()
    np.testing.assert_allclose(along(jolt, n)[n:], steady[n:], atol=0.01 * np.abs(steady).max())


def test_steps_within_a_sample_are_no_loop_of_the_program():
    """Of so few operations each the loop was most of the time: without, a lag takes less than half."""
    x, parts = np.ones(50), []

    def look(equations, inside):
        for one in equations:
            loop = one.primitive.name in ("scan", "while")
            parts.extend([inside] * loop)
            for value in one.params.values():
                if hasattr(value, "eqns") or hasattr(value, "jaxpr"):
                    look(getattr(value, "jaxpr", value).eqns, inside or loop)

    def swung(*driven):
        return deflection(*driven, 2500.0, 9.0, 0.01, 0.0, 1e-3, 0)

    look(jax.make_jaxpr(swung)(x, 0.0 * x, 0.0 * x, x).jaxpr.eqns, False)
    assert parts and not any(parts)


def test_a_fast_log_asks_for_no_shorter_steps_than_a_slow_one():
    """Four steps a sample at 1 kHz took four times as long as they do at 250 Hz, and told the same lag."""
    t = np.arange(4000) / 1000.0
    torque = 60.0 * np.cos(2 * np.pi * 0.8 * t)
    shape = np.ones(len(t))
    driven = INERTIA * shape, 0.0 * shape, 0.0 * shape, torque
    steps = substeps_of(1e-3)
    few, many = (
        np.asarray(deflection(*driven, STIFFNESS, DAMPING, GAP, 0.0, 1e-3, 0, each)[0])
        for each in (steps, 4)
    )
    assert steps == 1 and substeps_of(4e-3) == 4
    np.testing.assert_allclose(few, many, atol=0.02 * GAP)
