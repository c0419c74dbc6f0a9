"""What a law derives from its parameters is as sure as the log tells it, not as sure as these are."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.identify.estimation.derived import derived_errors
from jaxswarm.identify.report.summary import term_parameters, with_intervals
from jaxswarm.identify.synthetic import Noise, random_links, synthetic_log
from jaxswarm.logs.motion import Filtering, prepare
from jaxswarm.robot import robot_from_dh

BARE = robot_from_dh(
    "small", convention="modified", alpha=[np.pi / 2, 0.3], a=[0.0, 0.35], d=[0.0, 0.1]
)
ARM = BARE.replace(parameters=jnp.asarray(random_links(BARE, np.random.default_rng(0), mass=6.0)))
FRICTION = tuple(
    replace(t, values={"b": 2.0, "fc": 2.0})
    for t in parse_terms("viscous_friction,coulomb_friction", ARM.joints)
)


def fitted(hidden: Term, seed: int):
    """The hidden term of a log as a fit from its true values tells it, with standard errors."""
    log = synthetic_log(ARM, (*FRICTION, hidden), seed, noise=Noise(2e-5, 0.1), duration=12.0)
    found = estimate(ARM, (*FRICTION, hidden), [prepare(log, Filtering(20.0, 10.0))])
    return found.model.terms[-1], found.std_errors[-1]


def test_of_a_spring_with_slack_the_end_that_is_reached_is_sure():
    spring = Term("dead_zone_spring", 1, values={"k": 20.0, "q0": -1.6, "gap": 1.9})
    term, errors = fitted(spring, 1)
    assert errors["high"] < 0.02 and errors["q0"] > 10.0 * errors["high"]
    assert abs(term.values["q0"] + term.values["gap"] - 0.3) < 4.0 * errors["high"]
    table = with_intervals(term_parameters(term, ARM, errors))
    low, high = table["low"]["interval_95"], table["high"]["interval_95"]
    assert low[1] - low[0] > 10.0 * (high[1] - high[0])


@pytest.mark.parametrize(
    ("hidden", "name", "true"),
    [
        (Term("hysteresis", 1, values={"fc": 4.0, "x0": 0.08}), "sigma", 50.0),
        (Term("relaxing_spring", 1, values={"k": 15.0, "tc": 0.3}), "d", 4.5),
        (Term("joint_spring", 1, values={"k": 8.0, "tau0": 2.0}), "q0", -0.25),
    ],
    ids=lambda x: getattr(x, "effect", str(x)),
)
def test_a_derived_value_is_within_its_errors_and_no_wider_than_it_scatters(hidden, name, true):
    """Over twelve logs: the chance that one of twelve is beyond 3.5 errors is 0.6 %."""
    told = [fitted(hidden, seed) for seed in range(1, 13)]
    off = [(term.law.derived(term.values)[name][0] - true) / e[name] for term, e in told]
    assert np.abs(off).max() < 3.5
    # Of twelve normal errors the root mean square is below 0.45 in one of 3000.
    assert np.sqrt(np.mean(np.square(off))) > 0.45


def test_what_is_derived_from_a_value_that_is_not_told_is_not_told():
    slip = Term("hysteresis", 0, values={"fc": 4.0, "x0": 0.08})
    covariance = np.array([[1.0, np.nan], [np.nan, np.nan]])
    told = derived_errors(slip, ["fc", "x0"], covariance, {"fc": 1.0, "x0": np.nan})
    assert np.isnan(told["sigma"])
    plain = Term("viscous_friction", 0, values={"b": 2.0})
    assert derived_errors(plain, ["b"], np.eye(1), {"b": 1.0}) == {}
