"""Objectives on the host: the same search as inside a program, pools, time limits, failures."""

import time
from concurrent.futures import ThreadPoolExecutor

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import rosen

from jaxswarm.errors import InputError
from jaxswarm.swarm import Choice, Driver, Space, cma_es, gpso, minimize, pso, stalled, target

KEY = jax.random.key(2)
SPACE = Space.vector([-2.0] * 3, [2.0] * 3)


def sphere(x, _=None):
    return ((x - 1.0) ** 2).sum()


@pytest.mark.parametrize("stop", [None, stalled(3), target(0.3)])
def test_the_steps_are_those_of_minimize(stop):
    inside = minimize(sphere, gpso(6), SPACE, KEY, num_steps=15, stop=stop)
    outside = Driver(gpso(6), SPACE, KEY, num_steps=15, stop=stop).run(sphere)
    steps = int(inside.num_steps)
    # The histories first: where they part tells whether a step or its stop rule went another way.
    np.testing.assert_allclose(outside.history, inside.history[:steps], rtol=1e-12)
    assert int(outside.num_steps) == steps and outside.status.message == inside.status.message
    np.testing.assert_allclose(outside.params, inside.params, rtol=1e-12)
    assert int(outside.num_evaluations) == int(inside.num_evaluations)


def test_an_objective_of_scipy_with_a_pool():
    with ThreadPoolExecutor(2) as pool:
        driver = Driver(cma_es(), SPACE, KEY, num_steps=250, stop=target(1e-8))
        result = driver.run(rosen, pool=pool, timeout=60.0)
    assert float(result.value) <= 1e-8 and driver.num_timeouts == 0
    np.testing.assert_allclose(result.params, 1.0, atol=1e-3)
    whole = Driver(cma_es(), SPACE, KEY, num_steps=3)
    whole.run(lambda population: [rosen(x) for x in population], vectorized=True)
    assert len(whole.history) == 3


def test_a_candidate_that_hangs_is_told_as_infinite():
    told = []

    def hangs(params):
        if params["kind"] == 1:
            time.sleep(1.5)
        return float(params["x"] ** 2)

    space = Space(x=(-1.0, 1.0), kind=Choice(("quick", "slow")))
    driver = Driver(pso(6), space, KEY, num_steps=2)
    slow = sum(int(params["kind"]) for params in driver.ask())
    assert 0 < slow < 6
    tell = driver.tell
    driver.tell = lambda values: (told.append(values), tell(values))
    with ThreadPoolExecutor(12) as pool:
        driver.run(hangs, pool=pool, timeout=0.4)
    assert np.isinf(told[0]).sum() == slow and driver.num_timeouts >= slow
    assert np.isfinite(driver.state.best_value)


def test_workers_that_are_all_stuck_do_not_stop_the_search():
    with ThreadPoolExecutor(1) as pool:
        driver = Driver(pso(3), SPACE, KEY, num_steps=1)
        result = driver.run(lambda x: time.sleep(1.0), pool=pool, timeout=0.2)
    assert driver.num_timeouts == 3
    assert result.status.message.startswith("no candidate ever had a finite value")


def test_failures_are_raised_or_forgiven():
    def fails(x):
        if x[0] > 0.0:
            raise FloatingPointError("diverged")
        return float(x[0] ** 2)

    with pytest.raises(FloatingPointError):
        Driver(pso(8), SPACE, KEY, num_steps=3).run(fails)
    forgiven = Driver(pso(8), SPACE, KEY, num_steps=3).run(fails, forgive=(FloatingPointError,))
    assert float(forgiven.params[0]) <= 0.0


def test_going_on_from_a_state():
    half = Driver(pso(6), SPACE, KEY, num_steps=5)
    half.run(sphere)
    rest = Driver(pso(6), SPACE, KEY, num_steps=5, state=half.state).run(sphere)
    whole = Driver(pso(6), SPACE, KEY, num_steps=10).run(sphere)
    np.testing.assert_array_equal(rest.params, whole.params)


def test_what_does_not_fit_is_refused():
    driver = Driver(pso(6), SPACE, KEY, num_steps=1)
    with pytest.raises(InputError, match=r"shape \(5,\), expected \(6,\): tell one number"):
        driver.tell([1.0] * 5)
    with pytest.raises(InputError, match="needs a pool"):
        driver.run(sphere, timeout=1.0)
    driver.tell(jnp.ones(6))
    assert driver.finished
