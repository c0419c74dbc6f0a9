"""Polish: reaches the minimum, within the bounds, never worse than its start."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import least_squares

from jaxswarm.errors import InputError
from jaxswarm.swarm import Space, de, lshade, minimize, polish, pso, restart
from jaxswarm.swarm.polish import _candidates, _distinct

SPACE = Space(a=(0.1, 5.0), b=(0.1, 5.0))
T = np.linspace(0.0, 2.0, 20)


def residuals(p, data):
    return p["a"] * jnp.exp(-p["b"] * T) - data


def value(p, data):
    return jnp.sum(residuals(p, data) ** 2)


DATA = 2.0 * np.exp(-1.3 * T) + 0.01 * np.sin(9 * T)
RESULT = minimize(value, pso(8), SPACE, jax.random.key(0), jnp.asarray(DATA), num_steps=5)


@pytest.mark.parametrize(
    "method, steps, tolerance",
    [("lbfgs", 60, 1e-6), ("levenberg_marquardt", 30, 1e-8), ("adam", 1500, 1e-2)],
)
def test_reaches_the_least_squares_solution(method, steps, tolerance):
    fn = residuals if method == "levenberg_marquardt" else value
    best = least_squares(
        lambda p: p[0] * np.exp(-p[1] * T) - DATA, [1.0, 1.0], xtol=1e-14, ftol=1e-14, gtol=1e-14
    )
    polished = polish(fn, SPACE, RESULT.state, DATA, method=method, num_steps=steps)
    np.testing.assert_allclose(polished.params["a"], best.x[0], rtol=tolerance)
    np.testing.assert_allclose(polished.params["b"], best.x[1], rtol=tolerance)
    assert float(polished.value) <= float(polished.start_value)
    np.testing.assert_allclose(polished.start_value, RESULT.value, rtol=1e-9)


@pytest.mark.parametrize("method", ["lbfgs", "levenberg_marquardt"])
def test_solution_on_a_bound_is_found_and_kept(method):
    space = Space.vector([1.0, -1.0], [3.0, 1.0])  # the minimum (0, 0.2) lies outside
    fn = lambda x, _: x - jnp.array([0.0, 0.2])  # noqa: E731
    whole = (lambda x, _: jnp.sum(fn(x, _) ** 2)) if method == "lbfgs" else fn
    polished = polish(whole, space, jnp.array([0.6, 0.3]), method=method)
    assert float(polished.params[0]) == 1.0
    np.testing.assert_allclose(polished.params[1], 0.2, atol=1e-5)


@pytest.mark.parametrize("method", ["lbfgs", "adam"])
def test_never_worse_than_the_start(method):
    """A function that is rough, and not finite in places."""
    space = Space.vector([-1.0], [1.0])

    def rough(x, _):
        return jnp.where(x[0] > 0.5, jnp.nan, jnp.sin(200.0 * x[0]) + x[0] ** 2)

    for start in np.linspace(0.02, 0.7, 8):
        polished = polish(rough, space, jnp.array([start]), method=method, num_steps=20)
        assert float(polished.value) <= float(polished.start_value)


def test_bad_calls_are_named():
    with pytest.raises(InputError, match="method='bfgs' is unknown. .*lbfgs"):
        polish(value, SPACE, RESULT.state, DATA, method="bfgs")
    with pytest.raises(InputError, match="needs a scalar"):
        polish(residuals, SPACE, RESULT.state, DATA)
    with pytest.raises(InputError, match="needs residuals"):
        polish(value, SPACE, RESULT.state, DATA, method="levenberg_marquardt")


@pytest.mark.parametrize("build", [lambda: de(30), lambda: restart(de(30)), lambda: lshade(20)])
def test_the_best_of_a_population_that_differ_are_where_it_starts(build):
    """Many valleys, of which a population holds several: the members are ranked by NumPy here."""
    space = Space.vector([-5.0] * 2, [5.0] * 2)

    def valleys(x, _):
        return jnp.sum(x**2 / 10.0 - jnp.cos(2.0 * np.pi * x))

    result = minimize(valleys, build(), space, jax.random.key(2), num_steps=4)
    inner = getattr(result.state, "inner", result.state)
    members = np.unique(np.asarray(inner.members), axis=0)
    values = np.array([valleys(10.0 * x - 5.0, None) for x in members])
    points = _candidates(result.state)
    starts = _distinct(points, jax.vmap(lambda x: valleys(space.decode(x), None))(points), 5)
    np.testing.assert_allclose(starts, members[np.argsort(values)[:5]])
    # From every one of them, as the lowest of all that lie in their valleys.
    each = [polish(valleys, space, start, num_steps=30).value for start in starts]
    polished = polish(valleys, space, result.state, num_steps=30, top=5)
    assert len({round(float(value), 3) for value in each}) > 1
    np.testing.assert_allclose(polished.value, min(each), atol=1e-12)
