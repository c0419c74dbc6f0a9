"""Loads are found for the joints that are asked for, and are those of all."""

import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.identify.forward import columns as columns_of
from jaxswarm.identify.forward import load_slopes as slopes
from jaxswarm.identify.forward.columns import load_along, rigid_of
from jaxswarm.identify.forward.measuring_chain import assemble
from jaxswarm.identify.synthetic import random_links, synthetic_log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import rx60


def arm():
    robot = rx60()
    return robot.replace(parameters=random_links(robot, np.random.default_rng(0)))


def rigid_and_pi():
    log = prepare(synthetic_log(arm(), (), 1, duration=4.0))
    return rigid_of(arm(), log), np.asarray(arm().parameters).ravel(), log


def test_the_load_of_a_joint_is_that_of_the_recursion_and_nothing_is_told_of_others():
    rigid, pi, log = rigid_and_pi()
    wanted = load_along(arm(), (log.q, log.dq, log.ddq), pi)
    one = rigid.load(pi, {1})
    assert np.isnan(one.full[:, 0]).all() and np.isnan(one.static[:, 0]).all()
    for told, known in ((one.full, wanted.full), (one.static, wanted.static)):
        np.testing.assert_allclose(told[:, 1], known[:, 1], atol=1e-10 * np.abs(known).max())
    every = rigid.load(pi)
    np.testing.assert_allclose(every.full, wanted.full, atol=1e-10 * np.abs(wanted.full).max())
    np.testing.assert_allclose(every.static, wanted.static, atol=1e-10)
    other = rigid.load(2.0 * pi, {0})
    np.testing.assert_array_equal(other.full[:, 0], 2.0 * every.full[:, 0])


def test_a_model_with_a_law_of_the_load_asks_for_that_joint_alone():
    rigid, pi, log = rigid_and_pi()
    terms = (Term("load_dependent_friction", 1, values={"inertial": 1.0}),)
    columns = assemble(arm(), terms, log, (0.01,) * 3, pi, rigid)
    assert np.isfinite(columns).all()
    assert np.isnan(rigid.load(pi, ()).full[:, 0]).all()


def test_columns_times_slopes_are_added_up_as_they_are():
    rng = np.random.default_rng(0)
    by, still = rng.normal(size=(2, 1300))
    full, rest = rng.normal(size=(2, 1300, 7))
    told = slopes._by_columns((by, still), (full, rest))
    np.testing.assert_array_equal(told, by[:, None] * full + still[:, None] * rest)
    told = slopes._by_columns((by, 0.0 * still), (full, rest))
    np.testing.assert_array_equal(told, by[:, None] * full)


def test_loads_of_a_log_that_became_too_long_to_keep_are_the_same(monkeypatch):
    """What was asked for before it did is told on."""
    rigid, pi, _ = rigid_and_pi()
    own = rigid.load(pi, {1}).full[:, 1]
    monkeypatch.setattr(columns_of, "is_kept", lambda motion: False)
    np.testing.assert_array_equal(rigid.load(pi).full[:, 1], own)
    rigid.loads.clear()
    every = rigid.load(pi, {0})
    np.testing.assert_allclose(every.full[:, 1], own, atol=1e-10 * np.abs(own).max())
