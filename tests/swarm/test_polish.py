"""Polish: reaches the minimum, within the bounds, never worse than its start."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import least_squares

from jaxswarm.errors import InputError
from jaxswarm.swarm import Space, minimize, polish, pso

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
