"""What a fit makes of a place: its torque first, columns only where it goes; and laws of a motion once."""

import numpy as np
import pytest
from small_problems import make_motion, planar_arm

from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation import gauss_newton, problem
from jaxswarm.identify.estimation.free_parameters import Place
from jaxswarm.identify.estimation.gauss_newton import settle
from jaxswarm.identify.forward import measuring_chain, regression
from jaxswarm.identify.forward.columns import rigid_of
from jaxswarm.identify.forward.measuring_chain import assemble
from jaxswarm.identify.forward.regression import build_regression, with_slopes
from jaxswarm.identify.forward.torque_along import torque_along

ARM = planar_arm()
PI = np.asarray(ARM.parameters).ravel()
WIDTH = (0.05, 0.05)
SOFT = Term("joint_elasticity", 1, values={"k": 60.0, "d": 0.5})
STRIBECK = Term("stribeck_friction", 0, values={"df": 0.6, "vs": 0.3, "delta": 2.0})
BY_LOAD = Term("load_dependent_friction", 0, values={"mu": 0.1, "inertial": 0.4})
WRONG = Term("encoder_eccentricity", 0, values={"sine": 0.02, "cosine": 0.01})
MODELS = [(BY_LOAD,), (STRIBECK, SOFT), (BY_LOAD, SOFT), (WRONG, STRIBECK), (WRONG, SOFT, BY_LOAD)]


def linear(*terms):
    return np.concatenate([PI, [t.values[n] for t in terms for n in t.linear_names(ARM.joints)]])


@pytest.mark.parametrize("terms", MODELS, ids=lambda ts: "+".join(t.effect for t in ts))
def test_rows_without_slopes_leave_what_the_model_leaves(terms):
    motion, theta = make_motion(ARM, length=400), linear(*terms)
    at = ARM, terms, [motion], WIDTH, PI
    plain, whole = (build_regression(*at, bent=bent) for bent in (False, True))
    torque = motion.decimator.apply(torque_along(ARM, terms, motion, WIDTH, theta))
    left = np.where(plain.used_rows, plain.torque - torque, 0.0)
    for rows in (plain, whole, with_slopes(build_regression(*at, bent=False), *at)):
        np.testing.assert_allclose(rows.target - rows.columns @ theta, left, atol=1e-8)
    bends = bool({BY_LOAD, SOFT}.intersection(terms))
    assert (np.abs(whole.columns - plain.columns).max() > 1e-3) == bends


def test_how_the_torque_bends_is_not_asked_where_a_fit_does_not_go(monkeypatch):
    """Of a joint with backlash two thirds of all places were turned down; slopes took half of the time."""
    bent, true_cost = [], gauss_newton._true_cost
    monkeypatch.setattr(regression, "with_slopes", lambda plain, *at: bent.append(at) or plain)
    monkeypatch.setattr(problem, "with_slopes", None)
    motion = make_motion(ARM, length=400)
    here = problem.Problem(ARM, (motion,), (rigid_of(ARM, motion),), False)
    asked: list[float] = []

    def cost(*given):
        asked.append(true_cost(*given))
        return 1e300 if len(asked) == 1 else np.inf

    monkeypatch.setattr(gauss_newton, "_true_cost", cost)
    settle(here, Place((BY_LOAD, SOFT), WIDTH), 3.0 * PI)
    assert len(asked) == 4 and len(bent) == 1


def test_a_round_that_promises_nothing_is_not_tried(monkeypatch):
    """The model would be built once more for every length of a step that is no step."""
    rng, built = np.random.default_rng(0), []
    noise = rng.normal(size=(400, 2))
    motion = make_motion(ARM, lambda q, dq, ddq: 0.5 * dq + 0.05 * noise, length=400)
    here = problem.Problem(ARM, (motion,), (rigid_of(ARM, motion),), False)
    place = Place((SOFT,), WIDTH)
    found = settle(here, place, PI)
    for _ in range(3):
        found = settle(here, place, found.pi)
    build = problem.Problem.build
    monkeypatch.setattr(problem.Problem, "build", lambda *at: built.append(at) or build(*at))
    # The way that is left is far beyond rounding, but it leads nowhere.
    off = found.pi + 1e-5 * np.abs(found.pi).max() * (found.pi != 0)
    again = settle(here, place, off)
    assert len(built) == 1
    assert np.square(again.residual).sum() < (1.0 + 1e-4) * np.square(found.residual).sum()


def test_laws_of_the_motors_motion_are_made_once_though_links_lag(monkeypatch):
    motion = make_motion(ARM, length=400)
    rigid, terms = rigid_of(ARM, motion), (STRIBECK, SOFT)
    assemble(ARM, terms, motion, WIDTH, PI, rigid, decimate=True)
    told = assemble(ARM, terms, motion, WIDTH, 1.1 * PI, None, decimate=True)
    monkeypatch.setattr(measuring_chain, "term_columns", None)
    again = assemble(ARM, terms, motion, WIDTH, 1.1 * PI, rigid, decimate=True)
    np.testing.assert_allclose(again, told, atol=1e-9 * np.abs(told).max())


@pytest.mark.parametrize("beside", [(), (SOFT,)], ids=["stiff", "soft"])
def test_laws_are_made_anew_where_an_encoder_misreads_the_motion(beside):
    motion = make_motion(ARM, length=400)
    rigid = rigid_of(ARM, motion)
    assemble(ARM, (STRIBECK, SOFT), motion, WIDTH, PI, rigid, decimate=True)
    terms = (STRIBECK, WRONG, *beside)
    told = assemble(ARM, terms, motion, WIDTH, PI, None, decimate=True)
    again = assemble(ARM, terms, motion, WIDTH, PI, rigid, decimate=True)
    np.testing.assert_allclose(again, told, atol=1e-9 * np.abs(told).max())
