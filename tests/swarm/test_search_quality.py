"""Search quality over many seeds: the hash is as good as threefry, and the optimizers converge."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy import stats

from jaxswarm.swarm import OPTIMIZERS, Space, minimize_runs, pso

DIMS, RUNS = 5, 48
SPACE = Space.vector([-5.0] * DIMS, [5.0] * DIMS)
KEYS = jax.random.split(jax.random.key(0), RUNS)
ROTATION = np.linalg.qr(np.random.default_rng(0).normal(size=(DIMS, DIMS)))[0]


def problem(x, ripple):
    """Ellipsoid, rotated and off the center; with ripple, many local minima."""
    z = (x - 1.3) @ ROTATION
    return jnp.sum(z**2 * 10.0 ** np.linspace(0, 2, DIMS) + ripple * jnp.sin(3.0 * z) ** 2, axis=1)


@pytest.mark.parametrize("ripple", [0.0, 10.0])
def test_hash_searches_as_well_as_threefry(ripple):
    values = [
        minimize_runs(problem, pso(20, random=source), SPACE, KEYS, ripple, num_steps=60).value
        for source in ("hash", "threefry")
    ]
    assert stats.mannwhitneyu(*map(np.asarray, values)).pvalue > 1e-3


@pytest.mark.parametrize("name, bound", [("pso", 1e-3), ("de", 1e-2), ("cma_es", 1e-9)])
def test_median_run_converges(name, bound):
    optimizer = OPTIMIZERS[name].factory(20)
    result = minimize_runs(problem, optimizer, SPACE, KEYS, 0.0, num_steps=150)
    assert float(jnp.median(result.value)) < bound
