"""Widths are chosen with links where they are, whose columns are known; nothing but laws is made anew."""

from dataclasses import replace

import numpy as np
import pytest
from small_problems import make_motion, planar_arm

from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.choose_widths import choose_widths
from jaxswarm.identify.estimation.free_parameters import Place
from jaxswarm.identify.estimation.gauss_newton import settle
from jaxswarm.identify.estimation.links_held import LinksHeld, links_can_be_held
from jaxswarm.identify.estimation.problem import Problem
from jaxswarm.identify.forward import body, measuring_chain
from jaxswarm.identify.forward.columns import rigid_of

ARM = planar_arm()
PI = np.asarray(ARM.parameters).ravel()
WIDTH = (0.05, 0.05)
SOFT = Term("joint_elasticity", 1, values={"k": 60.0, "d": 0.5})
DRY = tuple(Term("coulomb_friction", j, values={"fc": 0.5}) for j in (0, 1))
BY_LOAD = Term("load_dependent_friction", 0, values={"mu": 0.1, "inertial": 0.4})
WRONG = Term("encoder_eccentricity", 0, values={"s1": 0.02, "c1": 0.01})
LATE = Term("torque_lag", None, values={"tc": 0.01, "seconds": 0.0})
TERMS = (*DRY, SOFT)


def dry_problem(widths):
    """An arm whose joints' signs have widths of their own."""
    rng = np.random.default_rng(0)

    def friction(q, dq, ddq):
        return 0.5 * np.tanh(dq / np.array(widths)) + 0.01 * rng.normal(size=dq.shape)

    motion = make_motion(ARM, friction, length=800)
    return Problem(ARM, (motion,), (rigid_of(ARM, motion),), False)


def test_links_are_held_where_they_alone_follow_the_parameters():
    assert links_can_be_held(TERMS)
    assert links_can_be_held((*DRY, LATE))  # a filter's time is a parameter like a stiffness
    assert not links_can_be_held(DRY)  # nothing moves
    assert not links_can_be_held((*TERMS, BY_LOAD))  # what a law sees moves
    # What an encoder says too much stays, and laws see what is left of the motion.
    assert links_can_be_held((*TERMS, WRONG)) and links_can_be_held((*DRY, WRONG))


@pytest.mark.parametrize("terms", [TERMS, (*TERMS, WRONG)], ids=["soft", "misread"])
def test_rows_of_held_links_are_those_of_the_problem_but_for_their_lag(terms):
    problem = dry_problem(WIDTH)
    place = Place(terms, WIDTH)
    here = settle(problem, place, PI)
    held = LinksHeld.about(problem, here)
    own = held.build(here.place, 2.0 * here.pi)
    np.testing.assert_array_equal(own.columns, here.regression.columns)
    wider = here.place._replace(width=(0.1, 0.05))
    rows, true = held.build(wider, here.pi), problem.build(wider, here.pi)
    np.testing.assert_allclose(rows.columns[:, :, 20:], true.columns[:, :, 20:], atol=1e-12)
    np.testing.assert_array_equal(rows.columns[:, :, :20], here.regression.columns[:, :, :20])
    left = held.left(rows, wider, here.theta)
    np.testing.assert_allclose(left, rows.target - rows.columns @ here.theta)
    assert [one.name for one in held.free(terms)] == []
    assert [one.name for one in problem.free(terms)][:2] == ["k", "d"]


def test_widths_are_chosen_without_moving_links(monkeypatch):
    """Of 569 s for a log of 36 s with backlash, 300 went into fits that asked which widths it tells."""
    moved, link_motion = [], body.link_motion
    monkeypatch.setattr(body, "link_motion", lambda *at: moved.append(at) or link_motion(*at))
    problem = dry_problem(WIDTH)
    here = settle(problem, Place(TERMS, WIDTH), PI)
    moved.clear()
    found, moving, _ = choose_widths(problem, here, problem.free(TERMS), [(0, 1)])
    assert not moved and found is here
    assert [one.name for one in moving] == ["k", "d"]


def test_widths_are_chosen_beside_one_and_the_same_filter(monkeypatch):
    problem = dry_problem(WIDTH)
    here = settle(problem, Place((*DRY, LATE), WIDTH), PI)
    made, report = [], measuring_chain.report
    monkeypatch.setattr(measuring_chain, "report", lambda *of: made.append(of) or report(*of))
    found, moving, _ = choose_widths(problem, here, problem.free(here.place.terms), [(0, 1)])
    assert not made and found is here
    assert [one.name for one in moving] == ["tc", "seconds"]


def test_the_fit_with_other_widths_is_one_of_the_whole_problem():
    problem = dry_problem((0.02, 0.2))
    stiff = replace(SOFT, values={"k": 3e4, "d": 3.0})
    here = settle(problem, Place((*DRY, stiff), WIDTH), PI)
    found, moving, _ = choose_widths(problem, here, problem.free(here.place.terms), [(0, 1)])
    np.testing.assert_allclose(found.place.width, (0.02, 0.2), rtol=0.1)
    assert [one.name for one in moving][:2] == ["k", "d"]
    true = problem.build(found.place, found.pi)
    np.testing.assert_allclose(found.regression.columns, true.columns, atol=1e-9)
