"""What a fit makes of a place: its torque first, columns only where it goes; and laws of a motion once."""

from dataclasses import replace

import numpy as np
import pytest
from small_problems import make_motion, planar_arm

from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation import gauss_newton, problem
from jaxswarm.identify.estimation.free_parameters import Place
from jaxswarm.identify.estimation.gauss_newton import settle
from jaxswarm.identify.forward import body, measuring_chain
from jaxswarm.identify.forward.columns import rigid_of
from jaxswarm.identify.forward.measuring_chain import assemble, low_torque_along

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


def problem_of(motion):
    return problem.Problem(ARM, (motion,), (rigid_of(ARM, motion),), False)


@pytest.mark.parametrize("terms", MODELS, ids=lambda ts: "+".join(t.effect for t in ts))
def test_a_torque_without_columns_is_that_of_the_columns(terms):
    """Of the model's own parameters, and of others that links and loads do not go by."""
    motion, theta = make_motion(ARM, length=400), linear(*terms)
    here, place = problem_of(motion), Place(terms, WIDTH)
    rows = here.build(place, PI)
    other = here.build(place, 1.2 * PI)
    left = here.left(other, place, theta)
    np.testing.assert_allclose(left, rows.target - rows.columns @ theta, atol=1e-8)
    columns = assemble(ARM, terms, motion, WIDTH, PI, decimate=True)
    alone = low_torque_along(ARM, terms, motion, WIDTH, PI, 1.1 * theta, here.rigids[0])
    np.testing.assert_allclose(alone, columns @ (1.1 * theta), atol=1e-8)


def test_a_place_that_a_fit_turns_down_is_asked_for_its_torque_alone(monkeypatch):
    """Of a joint with backlash two thirds of all places were turned down; columns took most of the time."""
    built, asked, build = [], [], problem.Problem.build
    monkeypatch.setattr(problem.Problem, "build", lambda *at: built.append(at) or build(*at))
    monkeypatch.setattr(gauss_newton, "_true_cost", lambda *given: 1e300)
    monkeypatch.setattr(gauss_newton, "_cost_of", lambda *given: asked.append(given) or np.inf)
    settle(problem_of(make_motion(ARM, length=400)), Place((BY_LOAD, SOFT), WIDTH), 3.0 * PI)
    assert (len(asked), len(built)) == (3, 1)


def test_links_are_moved_once_for_a_torque_and_its_columns(monkeypatch):
    moved, link_motion = [], body.link_motion
    monkeypatch.setattr(body, "link_motion", lambda *at: moved.append(at) or link_motion(*at))
    here, place = problem_of(make_motion(ARM, length=400)), Place((SOFT, STRIBECK), WIDTH)
    rows = here.build(place, PI)
    here.left(rows, place, linear(SOFT, STRIBECK))
    assert len(moved) == 1
    softer = replace(SOFT, values={"k": 50.0, "d": 0.5})
    for there, pi in ((place, 1.1 * PI), (place._replace(terms=(softer, STRIBECK)), 1.1 * PI)):
        here.build(there, pi)
    assert len(moved) == 3


@pytest.mark.parametrize("beside", [(SOFT,), (WRONG,)], ids=["soft", "misread"])
def test_a_law_of_the_motors_motion_asks_for_its_own_torque_alone(beside, monkeypatch):
    """Where links lag each shape of friction took the links' torque four times; an encoder's error does ask."""
    here, place = problem_of(make_motion(ARM, length=400)), Place((STRIBECK, *beside), WIDTH)
    (free,) = [f for f in here.free(place.terms) if f.name == "vs"]
    faster = replace(STRIBECK, values={**STRIBECK.values, "vs": 0.4})
    ends, theta = (place, Place((faster, *beside), WIDTH)), linear(STRIBECK, *beside)
    whole = [
        assemble(ARM, one.terms, *here.motions, WIDTH, PI, decimate=True) @ theta for one in ends
    ]
    whole_model: list[tuple] = []
    torque = problem.low_torque_along
    monkeypatch.setattr(
        problem, "low_torque_along", lambda *at: whole_model.append(at) or torque(*at)
    )
    told = [here.output(one, PI, theta, free) for one in ends]
    np.testing.assert_allclose(told[1] - told[0], whole[1] - whole[0], atol=1e-9)
    assert bool(whole_model) == (beside == (WRONG,))


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


def test_columns_of_links_before_one_that_lags_are_not_made_again(monkeypatch):
    made, low_columns = [], body.low_columns
    monkeypatch.setattr(body, "low_columns", lambda *at: made.append(at[3]) or low_columns(*at))
    motion = make_motion(ARM, length=400)
    told = assemble(ARM, (SOFT,), motion, WIDTH, PI, rigid_of(ARM, motion), decimate=True)
    whole = assemble(ARM, (SOFT,), motion, WIDTH, PI, None, decimate=True)
    np.testing.assert_allclose(told, whole, atol=1e-12 * np.abs(whole).max())
    assert made == [SOFT.joint, 0]
