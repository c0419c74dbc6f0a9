"""A spring that lets go with time, against SciPy, and against what it is on slow and on fast motion."""

import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from jaxswarm.effects import get_law, make_sample
from jaxswarm.effects.series import law_torque

LAW = get_law("relaxing_spring")
K, TC = 12.0, 0.4


def along(hertz: float, tc: float, rate: float = 500.0, seconds: float = 20.0):
    """Times, positions and velocities (T,) of a sine from rest, and the law's torque along it."""
    t = np.arange(0.0, seconds, 1.0 / rate)
    w = 2.0 * np.pi * hertz
    q, dq = 1.0 - np.cos(w * t), w * np.sin(w * t)
    series = make_sample(t=jnp.asarray(t), q=jnp.asarray(q), dq=jnp.asarray(dq))
    return t, q, dq, np.asarray(law_torque(LAW, {"k": K, "tc": tc}, series))


def test_it_follows_its_equation():
    t, _, _, told = along(0.7, TC)
    w = 2.0 * np.pi * 0.7
    path = solve_ivp(
        lambda now, z: w * np.sin(w * now) - z / TC,
        *((0.0, t[-1]), [0.0]),
        **{"t_eval": t, "rtol": 1e-9, "atol": 1e-12},
    )
    np.testing.assert_allclose(told, K * path.y[0], atol=2e-4 * K)


def test_slow_motion_meets_friction_and_fast_motion_a_spring():
    _, _, dq, slow = along(0.05, 0.05)
    late = np.arange(len(dq)) > len(dq) // 2
    np.testing.assert_allclose(slow[late], K * 0.05 * dq[late], atol=0.03 * np.abs(slow).max())
    _, q, _, fast = along(2.0, 10.0, seconds=1.0)
    np.testing.assert_allclose(fast, K * q, atol=0.15 * np.abs(fast).max())


def test_held_in_a_place_it_lets_go():
    t = jnp.arange(0.0, 2.0, 1e-3)
    dq = jnp.where(t < 0.01, 10.0, 0.0)
    told = law_torque(LAW, {"k": K, "tc": TC}, make_sample(t=t, dq=dq))
    half, end = 1000, 1400
    assert float(told[end] / told[half]) == pytest.approx(np.exp(-0.4 / TC), rel=1e-6)


def test_a_log_that_begins_in_motion_begins_wound_up():
    t = jnp.arange(0.0, 1.0, 1e-3)
    told = law_torque(LAW, {"k": K, "tc": TC}, make_sample(t=t, dq=jnp.full_like(t, 0.5)))
    np.testing.assert_allclose(told, K * TC * 0.5, rtol=1e-9)
