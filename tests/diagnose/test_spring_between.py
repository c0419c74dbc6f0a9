"""A link that swings freely while its motor stands, at a frequency between those of the lattice."""

import numpy as np
import pytest
from planted import BAND
from scipy.integrate import solve_ivp

from jaxswarm.diagnose.candidates import transmission
from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import robot_from_dh

INERTIA, WEIGHT, FRICTION, NOISE, RATE = 1.2, 20.0, 4.0, 0.02, 250.0
# Half way between two frequencies of the lattice, with a thirtieth of critical damping.
SWINGING = 2.0 * np.pi * 0.87 * 10.0 ** (7.5 / 8.0)
K = INERTIA * SWINGING**2
D = 2.0 * 0.03 * INERTIA * SWINGING
ARM = robot_from_dh("arm", convention="modified", alpha=[np.pi / 2], a=[0.0], d=[0.0])
SPRING = Term("joint_elasticity", 0)


def moved(t):
    """Position, velocity and acceleration of a motor that goes up and down in 0.35 s, and waits."""
    s, up = np.clip((t % 1.6) / 0.35, 0.0, 1.0), np.where((t // 1.6) % 2, -1.0, 1.0)
    parts = (
        10 * s**3 - 15 * s**4 + 6 * s**5,
        (30 * s**2 - 60 * s**3 + 30 * s**4) / 0.35,
        (60 * s - 180 * s**2 + 120 * s**3) / 0.35**2,
    )
    q, dq, ddq = (0.5 * up * x for x in parts)
    return q - 0.25 * up, dq, ddq


@pytest.fixture(scope="module")
def lin():
    t = np.arange(0.0, 16.0, 1.0 / RATE)

    def rate(now, state):
        q, dq, _ = moved(now)
        e, de = q - state[0], dq - state[1]
        return state[1], (K * e + D * de - WEIGHT * np.cos(state[0])) / INERTIA

    path = solve_ivp(rate, (0.0, t[-1]), (moved(0.0)[0], 0.0), t_eval=t, max_step=2e-3)
    q, dq, _ = moved(t)
    rng = np.random.default_rng(0)
    tau = K * (q - path.y[0]) + D * (dq - path.y[1]) + FRICTION * np.tanh(dq / 0.02)
    log = Log(
        "swing",
        ARM.joints,
        t,
        (q + 1e-5 * rng.normal(size=len(t)))[:, None],
        tau=(tau + NOISE * rng.normal(size=len(t)))[:, None],
    )
    declared = parse_terms("viscous_friction,coulomb_friction", ARM.joints)
    found = estimate(ARM, declared, [prepare(log, BAND)], bounded=False)
    return lambda: Linearization(found, cross_fit(found), Memory())


def test_stiffnesses_between_those_of_the_lattice_are_tried(lin, monkeypatch):
    (fine,) = score_terms(lin(), [SPRING], 0)
    monkeypatch.setattr(transmission, "_WORTH_MORE", 1.0)
    (coarse,) = score_terms(lin(), [SPRING], 0)
    assert fine.share > 2.0 * coarse.share
    assert fine.p_value < 1e-4 < 1e-3 < coarse.p_value
