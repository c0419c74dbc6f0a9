"""Widths of the smooth sign that joints share, or have of their own."""

import threading
from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import jax
import numpy as np
import pytest
from small_problems import make_motion, planar_arm

from jaxswarm import cores
from jaxswarm.effects.formula import DISCOVERED, Formula
from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.estimation import choose_widths as choosing
from jaxswarm.identify.estimation import sign_width
from jaxswarm.identify.estimation.own_widths import apart, told_by_the_others
from jaxswarm.identify.estimation.sign_width import driven_by_friction, width_groups
from jaxswarm.identify.estimation.standing import never_slow
from jaxswarm.identify.forward.columns import rigid_of
from jaxswarm.robot.dynamics import inverse_dynamics

LAWS = tuple(Term(e, j) for e in ("coulomb_friction", "viscous_friction") for j in range(2))


def friction(widths):
    return lambda q, dq, ddq: 2.0 * np.tanh(dq / np.array(widths)) + 0.5 * dq


def fitted(widths):
    motion = make_motion(planar_arm(), friction(widths), length=1500, noise=0.02)
    return np.array(estimate(planar_arm(), LAWS, [motion]).model.width)


def test_joints_of_one_width_share_it():
    width = fitted((0.3, 0.3))
    assert width[0] == width[1]
    assert abs(width[0] / 0.3 - 1.0) < 0.05


@pytest.mark.parametrize("widths", [(0.15, 0.5), (0.02, 0.2)])
def test_joints_of_clearly_different_widths_have_their_own(widths):
    """Also where the shared one is so sharp for a joint that no slope tells where its own is."""
    np.testing.assert_allclose(fitted(widths), widths, rtol=0.1)


@pytest.mark.parametrize("widths", [(0.2, 0.12), (0.14, 0.075), (0.3, 0.12)])
def test_a_joint_that_creeps_has_its_own_though_that_of_its_kind_is_beyond_its_speed(widths):
    """It kept the width of its kind, and a clean one was given a Stribeck law by that."""
    scale = np.array([1.0, 0.06])
    motion = make_motion(planar_arm(), friction(widths), length=1500, noise=0.02, scale=scale)
    shared = float(np.mean(widths))
    found = estimate(planar_arm(), LAWS, [motion], width=shared, refine_width=True).model
    np.testing.assert_allclose(found.width, widths, rtol=0.1)


def test_joints_that_come_near_rest_and_go_on_show_the_width_of_their_sign():
    """A part of its speed was a seventh of a slide's, and a clean one was left with 27 times its noise."""
    arm, widths = planar_arm(), np.array([0.5, 0.5])
    motion = make_motion(arm, length=1500)
    drift = -1.03 * motion.dq.min(axis=0)
    q, dq = motion.q + drift * motion.t[:, None], motion.dq + drift
    torque = np.asarray(jax.vmap(partial(inverse_dynamics, arm))(q, dq, motion.ddq))
    noise = 0.02 * np.random.default_rng(3).normal(size=q.shape)
    one_way = replace(motion, q=q, dq=dq, tau=torque + friction(widths)(q, dq, None) + noise)
    assert one_way.dq.min() > 0.0 and never_slow([one_way]).all()
    np.testing.assert_allclose(estimate(arm, LAWS, [one_way]).model.width, widths, rtol=0.1)


def test_widths_are_the_same_however_many_look_for_them(monkeypatch):
    motion = make_motion(planar_arm(), friction((0.15, 0.5)), length=1500, noise=0.02)
    threads = set()
    plain = sign_width.solved

    def solved(*args, **options):
        threads.add(threading.get_ident())
        return plain(*args, **options)

    monkeypatch.setattr(sign_width, "solved", solved)

    def found(count):
        threads.clear()
        monkeypatch.setattr(cores, "count", lambda: count)
        widths = sign_width.best_widths(
            planar_arm(), LAWS, [motion], [rigid_of(planar_arm(), motion)]
        )
        return widths, len(threads)

    alone, one = found(1)
    assert one == 1
    shared, several = found(2)
    assert several > 1 and shared == alone
    # Rows of a long log do not stand in memory twice.
    monkeypatch.setattr(sign_width, "is_kept", lambda motion: False)
    assert found(2) == (alone, 1)


@pytest.mark.parametrize("widths", [(0.05, 0.3), (0.03, 0.5)])
def test_widths_stay_where_a_fit_left_them(widths):
    """Else an effect of another joint moves them, and is blamed for what that does to other motion."""
    motion = make_motion(planar_arm(), friction(widths), length=1500, noise=0.3)
    first = estimate(planar_arm(), LAWS, [motion], bounded=False)
    start = np.asarray(first.model.robot.parameters).ravel()
    again = estimate(
        planar_arm(), LAWS, [motion],
        width=first.model.width, refine_width=True, bounded=False, start=start,
    )  # fmt: skip
    np.testing.assert_allclose(again.model.width, first.model.width, rtol=0.01)


def test_widths_that_were_apart_beside_a_model_that_lacked_a_law_are_shared_again():
    """Else they stay what noise and the missing law had made of them; a wrist's raised other motion's error."""
    motion = make_motion(planar_arm(), friction((0.3, 0.3)), length=1500, noise=0.3)
    lone = estimate(planar_arm(), LAWS, [motion], bounded=False)
    start = np.asarray(lone.model.robot.parameters).ravel()
    found = estimate(
        planar_arm(), LAWS, [motion],
        width=(0.351, 0.305), refine_width=True, bounded=False, start=start,
    )  # fmt: skip
    assert found.model.width[0] == found.model.width[1]
    np.testing.assert_allclose(found.model.width, lone.model.width, rtol=0.01)


def test_the_errors_of_friction_hold_the_doubt_of_a_width_that_is_held_where_it_came_to():
    """A second pass finds no width apart from where it is and holds all: as if known, a third of it."""
    widths = (0.1, 0.3)

    def stribeck(q, dq, ddq):
        curve = np.exp(-((dq / 0.3) ** 2)) * np.array([1.0, 0.0])
        return friction(widths)(q, dq, ddq) + curve * np.tanh(dq / widths[0])

    motion = make_motion(planar_arm(), stribeck, length=1500, noise=0.005)
    terms = (*LAWS, Term("stribeck_friction", 0))
    found = estimate(planar_arm(), terms, [motion])
    known = estimate(planar_arm(), terms, [motion], width=found.model.width)
    small, whole = (one.std_errors[-1]["df"] for one in (known, found))
    assert whole > 2.0 * small
    assert abs(found.model.terms[-1].values["df"] - 1.0) < 3.0 * whole


def test_a_single_joint_apart_frees_those_that_are_known_well_enough():
    x, error = np.array([0.9, -0.5, 0.1, 0.6]), np.array([0.02, 0.03, 0.02, 1.5])
    assert apart(x, error).tolist() == [0, 1, 2]


def test_no_joint_is_freed_for_what_may_be_chance():
    x, error = np.array([0.2, -0.4, 0.1]), np.array([0.07, 0.1, 0.05])
    assert not len(apart(x, error))
    assert not len(apart(np.zeros(0), np.zeros(0)))


def test_a_sign_far_off_is_freed_though_its_error_is_large():
    """What another joint lacks widens all errors; a sign four times too wide is still one."""
    x = np.array([-1.35, -0.12, -1.24, -1.49, -0.75, 0.04, 0.06])
    error = np.array([0.327, 0.041, 0.303, 0.292, 0.254, 0.016, 0.043])
    assert {0, 2, 3} <= set(apart(x, error).tolist())


def test_what_a_log_hardly_tells_leans_on_what_it_tells_of_the_others():
    width = (0.01, 0.02, 0.002, 0.002)
    middle = np.sqrt(0.01 * 0.02)
    sure = {0: (np.log(0.01), 0.02), 1: (np.log(0.02), 0.02), 3: (np.log(0.02), 0.02)}

    def told(error):
        return told_by_the_others([(0, 1, 2, 3)], {0, 1}, width, sure | {2: (np.log(0.002), error)})

    exact, half, nothing = (told(error) for error in (1e-3, 0.5, np.inf))
    assert exact[:2] == half[:2] == nothing[:2] == width[:2]
    assert exact[2] == pytest.approx(0.002, rel=1e-3)
    assert 0.002 < half[2] < middle < nothing[2] < 0.02
    # Each by its own doubt: joint 4 is known, whatever joint 3 is.
    assert all(w[3] == pytest.approx(0.02, rel=0.02) for w in (exact, half, nothing))


def test_widths_that_differ_together_though_none_does_alone_are_not_shared():
    """Six joints, each two to four standard errors from the shared width, as on a 11 s log of a world."""
    ratio = np.array([-0.53, -0.31, 0.15, -0.39, -0.41, -0.16, 0.29])
    error = np.array([0.2, 0.166, 0.052, 0.133, 0.191, 0.04, 0.08])
    true = np.array([-0.62, -0.5, 0.17, -0.36, -0.81, -0.17, 0.38])
    assert not len(apart(ratio, error))
    group = tuple(range(7))
    own = {j: (ratio[j], error[j]) for j in group}
    told = np.log(told_by_the_others([group], set(), (1.0,) * 7, own))
    assert np.sqrt(np.mean((told - true) ** 2)) < 0.8 * np.sqrt(np.mean(true**2))
    # What chance alone does to widths that are equal is shared.
    alike = {j: (own[j][0] / 3.0, own[j][1]) for j in group}
    assert told_by_the_others([group], set(), (1.0,) * 7, alike) == (1.0,) * 7


@pytest.mark.parametrize(
    ("fast", "least", "groups"),
    [((1,), 1.0, [(0, 1)]), ((0, 1), 1.0, []), ((0, 1), 0.06, []), ((0, 1), 0.04, [(0, 1)])],
)
def test_a_joint_that_races_through_zero_has_the_width_of_its_kind(fast, least, groups):
    """As a part of its speed a wrist's was 9 % off, and doubled its error on point-to-point motion."""
    motion = make_motion(planar_arm(), friction((0.3, 0.3)), length=1500, noise=0.02)
    dq = motion.dq.copy()
    dq[:, list(fast)] = np.where(dq[:, list(fast)] < 0.0, -1.0, 1.0)
    dq[0, fast[-1]] = least
    assert width_groups(planar_arm(), LAWS, [replace(motion, dq=dq)]) == groups


@pytest.mark.parametrize(
    ("doubt", "left"),
    [(0.1, 0.018 * 0.55**2), (0.3, 0.018 * 0.55), (0.6, 1e-4), (0.001, 0.018 * 0.55**4)],
)
def test_a_sign_is_as_sharp_as_the_log_tells_and_no_sharper(monkeypatch, doubt, left):
    """On a world it ran on to where no sample sees it, and at rest left five times the declared error."""

    def own(problem, here, groups):
        known, width = here.place.width
        error = doubt * (0.018 / width) ** 1.5
        return {0: (np.log(known), 0.01), 1: (np.log(0.55 * width), error)}

    def place(width):
        return SimpleNamespace(width=width, terms=(), _replace=lambda width: place(width))

    here = SimpleNamespace(place=place((0.018, 1e-4)))
    problem = SimpleNamespace(motions=[], free=lambda terms, widths: widths)
    monkeypatch.setattr(choosing, "widths_alone", own)
    monkeypatch.setattr(choosing, "free_widths", lambda motions, groups, width: list(groups))
    monkeypatch.setattr(
        choosing,
        "_moved",
        lambda problem, here, moving, width: SimpleNamespace(place=place(tuple(width))),
    )
    moving = [SimpleNamespace(joints=(0,)), SimpleNamespace(joints=(1,))]
    there, free, held = choosing._no_sharper_than_told(problem, here, moving, [], [(0, 1)], None)
    np.testing.assert_allclose(there.place.width, (0.018, left))
    assert (free, held) == ([(0,)], [(1,)])


@pytest.mark.parametrize("alone", [False, True])
def test_dry_friction_that_would_drive_a_joint_has_no_width(alone):
    """A wide sign of negative friction has the shape of a drag that the model lacks."""

    def torque(q, dq, ddq):
        drag = np.array([0.0, 0.4]) * dq * np.abs(dq)
        return 0.1 * np.tanh(dq / 0.05) * [not alone, 1.0] + 0.5 * dq + drag

    motion = make_motion(planar_arm(), torque, length=1500, noise=0.002)
    laws = tuple(t for t in LAWS if not (alone and t.place == ("coulomb_friction", 0, None)))
    found = estimate(planar_arm(), laws, [motion], bounded=False).model
    dry = next(t for t in found.terms if t.effect == "coulomb_friction" and t.joint == 1)
    assert dry.values["fc"] < 0.0
    assert found.width[1] < 0.1


@pytest.mark.parametrize(("lower", "driven"), [(-np.inf, set()), (0.0, {1})])
def test_a_law_that_may_have_any_sign_drives_nothing(lower, driven):
    size = Parameter("a", "N m/rad", lower, np.inf, True, 1.0, "slope")
    law = Term(DISCOVERED, 1, formula=Formula((("q", "direction", "*"),), (size,)))
    theta = np.append(np.zeros(20), -2.0)
    assert driven_by_friction(planar_arm(), [law], theta) == driven
