"""An arm whose joint sits askew on its parent is told by that, with the torque of the moved arm."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from elbow import ask, elbow, elbow_log, fitted, passing
from planted import BAND, NOISE

from jaxswarm.diagnose.selection.refit import refit, refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.effects.base import get_law
from jaxswarm.effects.placement import across, moved_joint, own_moves
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.identify.forward.placement import placement_columns
from jaxswarm.identify.synthetic import random_links, synthetic_log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import inverse_dynamics, robot_from_dh
from jaxswarm.simulate import Acting, make_plant

RIVALS = ("encoder_offset", "base_tilt", "gear_coupling_error", "encoder_eccentricity")
SKEW = {"x": 0.0, "y": 0.0, "turn_x": 0.12, "turn_y": 0.0}


def test_a_turned_axis_is_named_with_its_angle():
    # The log is that of the moved arm itself, not of the law's first order.
    bent = moved_joint(elbow(), 2, get_law("link_geometry").placement(SKEW))
    log = synthetic_log(bent, (), 1, noise=NOISE, duration=12.0, rate=125.0)
    found = fitted(log)
    best = passing(ask(found, "link_geometry", *RIVALS))[0]
    assert best.candidate.term.place == ("link_geometry", 2, None)
    # By all joints: by its own alone a spring told as much with two numbers less, and left one before it.
    assert best.own is None and best.per_joint[1] > 0.0
    after = refit_with(found, best)
    values = find_term(after, best.candidate.term).values
    assert values["turn_x"] == pytest.approx(0.12, rel=0.15)
    assert after.fit.sigma[2] < 0.4 * found.fit.sigma[2]


def test_a_large_turn_is_told_with_the_torque_of_the_turned_arm():
    """To first order its shifts came out 2 cm, six standard errors, off, and 1.18 times the noise was left."""
    bare = robot_from_dh(
        "bent",
        convention="modified",
        alpha=[0.0, np.pi / 2, 0.0, np.pi / 2],
        a=[0, 0, 0.5, 0.2],
        d=[0, 0, 0, 0.1],
    )
    links = random_links(bare, np.random.default_rng(4), mass=6.0)
    arm = bare.replace(parameters=jnp.asarray(links))
    turned = moved_joint(arm, 2, get_law("link_geometry").placement({**SKEW, "turn_x": 0.25}))
    declared = parse_terms("viscous_friction,coulomb_friction", arm.joints)

    def fit(world):
        log = synthetic_log(world, (), 1, noise=NOISE, duration=12.0, rate=125.0)
        return estimate(arm, declared, [prepare(log, BAND)], bounded=False)

    without, straight = fit(turned), fit(arm)
    after = refit(without, (*without.model.terms, Term("link_geometry", 2)))
    np.testing.assert_allclose(after.fit.sigma, straight.fit.sigma, rtol=0.05)
    values, errors = after.model.terms[-1].values, after.std_errors[-1]
    for name, true in {**SKEW, "turn_x": 0.25}.items():
        assert abs(values[name] - true) < 3.0 * errors[name]


def test_a_straight_arm_is_left_as_it_is():
    assert not passing(ask(fitted(elbow_log()), "link_geometry"))


def test_a_wrong_zero_is_not_taken_for_it():
    log = elbow_log(Term("encoder_offset", 1, values={"dq0": 0.06}))
    best = passing(ask(fitted(log), "link_geometry", "encoder_offset"))[0]
    assert best.candidate.term.place == ("encoder_offset", 1, None)


def test_moves_are_across_the_axes_and_columns_their_derivatives():
    arm, rng = elbow(), np.random.default_rng(0)
    directions = across(arm, 2)
    axis = np.asarray(arm.rotation[2]) @ np.asarray(arm.axis[2])
    np.testing.assert_allclose(directions @ directions.T, np.eye(2), atol=1e-12)
    np.testing.assert_allclose(directions @ axis, 0.0, atol=1e-12)
    np.testing.assert_allclose(directions[0] @ np.asarray(arm.axis[1]), 0.0, atol=1e-12)
    np.testing.assert_allclose(own_moves(arm, 2), [[1, 1], [1, 0]])
    moved, law = rng.normal(size=(3, 5, 3)), get_law("link_geometry")
    pi = np.asarray(arm.parameters).ravel()
    columns = placement_columns(law, 2, arm, tuple(moved), pi)
    small = {"x": 3e-4, "y": -2e-4, "turn_x": 4e-4, "turn_y": 0.0}
    bent = make_plant(arm, [Acting("link_geometry", 2, values=small)]).robot
    change = [jax.vmap(lambda *x, r=r: inverse_dynamics(r, *x))(*moved) for r in (bent, arm)]
    told = columns @ np.array([small[p.name] for p in law.parameters])
    np.testing.assert_allclose(np.subtract(*change), told, atol=3e-6)
    assert np.abs(told).max() > 1e-3
