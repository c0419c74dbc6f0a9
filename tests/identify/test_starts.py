"""Where declared laws that have several minima begin."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.effects import REGISTRY
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.estimation.clock_skew import estimate_with_clocks
from jaxswarm.identify.estimation.starts import with_starts
from jaxswarm.identify.synthetic import Noise, random_links, synthetic_log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot.dh import robot_from_dh

LEVER = Term("gravity_compensator", 1, values={"a": 6.0, "b": 0.7, "q0": 1.9})
FRICTION = (
    Term("viscous_friction", 1, values={"b": 1.0}),
    Term("coulomb_friction", 1, values={"fc": 1.0}),
)


@pytest.fixture(scope="module")
def lever():
    """An arm and its log with a spring on a lever."""
    bare = robot_from_dh(
        "small", convention="modified", alpha=[np.pi / 2, 0.3], a=[0.0, 0.35], d=[0.0, 0.1]
    )
    arm = bare.replace(
        parameters=jnp.asarray(random_links(bare, np.random.default_rng(0), mass=6.0))
    )
    log = synthetic_log(
        arm, (*FRICTION, LEVER), 0, noise=Noise(1e-5, 0.02), duration=12.0, rate=200.0
    )
    return arm, prepare(log)


def blank(*terms):
    return tuple(replace(t, values={}) for t in terms)


def test_a_spring_on_a_lever_begins_where_it_explains_most(lever):
    arm, motion = lever
    terms = blank(*FRICTION, LEVER)
    nominal = estimate(arm, terms, [motion])
    found = estimate_with_clocks(arm, terms, [motion])
    assert nominal.fit.sigma[1] > 3.0 * found.fit.sigma[1]
    for name, value in LEVER.values.items():
        assert found.model.terms[-1].values[name] == pytest.approx(value, rel=0.1), name


def test_what_is_given_or_has_one_minimum_stays(lever):
    arm, motion = lever
    given = replace(LEVER, values={"q0": 0.3})
    terms = (*blank(*FRICTION), given, Term("stribeck_friction", 0))
    assert with_starts(arm, terms, [motion]) is terms
    first, last = with_starts(arm, blank(LEVER, FRICTION[0]), [motion])
    assert first.effect == LEVER.effect and set(first.values) == {"b", "q0"}
    assert last.values == {}


@pytest.mark.parametrize("name", [n for n in sorted(REGISTRY) if REGISTRY[n].grid_size is not None])
def test_every_such_law_stays_in_its_place(lever, name):
    arm, motion = lever
    terms = (*blank(FRICTION[0]), Term(name, 1), *blank(FRICTION[1]))
    found = with_starts(arm, terms, [motion])
    assert [t.place for t in found] == [t.place for t in terms]
