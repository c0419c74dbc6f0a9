"""Where a link starts behind its motor: on the flank its load presses, whatever the first sample says."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from jaxswarm.effects.deflection import deflection

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


def test_a_spring_starts_in_the_equilibrium_of_its_first_torque():
    torque = np.linspace(-30.0, 90.0, 500)
    assert lag(torque, gap=0.0)[1] == pytest.approx(-30.0 / STIFFNESS, rel=0.05)
