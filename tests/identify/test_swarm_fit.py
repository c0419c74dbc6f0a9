"""A swarm on the compressed problem: never below the optimum, and at it where the search is whitened."""

import jax
import numpy as np
import pytest
from small_problems import make_regression, waves

from jaxswarm.errors import InputError
from jaxswarm.identify.estimation.least_squares import fit
from jaxswarm.identify.estimation.swarm_fit import swarm_fit, torque_cost

TRUTH = np.array([1.5, 0.7, 0.3])


@pytest.fixture(scope="module")
def solution():
    rng = np.random.default_rng(0)
    columns = waves(rng, 300, 2, 3)
    columns[:, :, 2] = columns[:, :, 1] + 0.02 * columns[:, :, 2]
    return fit(make_regression(columns, columns @ TRUTH + 0.1 * rng.normal(size=(300, 2))))


@pytest.fixture(scope="module")
def searches(solution):
    key, kind = jax.random.key(1), {"runs": 4, "num_steps": 600}
    return {
        white: swarm_fit(solution, "gpso", key, whiten=white, **kind) for white in (True, False)
    }


def test_whitened_search_reaches_the_optimum(searches, solution):
    found = searches[True]
    assert found.excess.max() < 1e-5
    np.testing.assert_allclose(found.values, solution.values, rtol=0.05)


def test_no_search_gets_below_the_optimum(searches):
    for found in searches.values():
        assert found.excess.min() >= -1e-12
        assert found.outside == 0


def test_the_valley_defeats_the_raw_search(searches):
    assert np.median(searches[True].costs) < np.median(searches[False].costs)


def test_history_falls_to_the_final_cost(searches):
    for found in searches.values():
        assert found.history.shape == (4, 600)
        assert (np.diff(found.history, axis=1) <= 0).all()
        np.testing.assert_allclose(found.history[:, -1], found.costs)


def test_reported_values_have_the_reported_cost(searches, solution):
    for found in searches.values():
        problem = (solution.factor, solution.target, solution.cost)
        cost = float(torque_cost(found.values[None], problem)[0])
        assert cost == pytest.approx(found.costs.min(), rel=1e-9)


def test_evaluations_are_all_counted(searches):
    assert searches[True].evaluations % (4 * 600) == 0


def test_bounds_confine_the_raw_search(solution):
    lower, upper = np.array([0.0, 0.0, 0.5]), np.full(3, np.inf)
    kind = {"runs": 2, "num_steps": 50, "lower": lower, "upper": upper}
    found = swarm_fit(solution, "gpso", jax.random.key(0), **kind)
    assert found.values[2] >= 0.5


def test_unknown_optimizers_are_named(solution):
    with pytest.raises(InputError, match="gpso"):
        swarm_fit(solution, "gspo", jax.random.key(0))
