"""Functions of steps: large populations damp their step size enough to walk over them."""

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.swarm import Space, cma_es, minimize_runs
from jaxswarm.swarm.optimizers.cma_distribution import Rates


def steps(x, scales):
    """An ellipsoid of steps a tenth wide near its center and one wide elsewhere, as BBOB's f7."""
    rounded = jnp.where(jnp.abs(x) > 0.5, jnp.floor(0.5 + x), jnp.floor(0.5 + 10.0 * x) / 10.0)
    return jnp.sum(scales * rounded**2)


def test_damping_is_that_of_pycma():
    """Values of ``cma.CMAEvolutionStrategy(...).adapt_sigma.damps - cs`` of pycma 4.5, to three digits."""
    for n, d, expected in [
        (8, 5, 1.0),
        (48, 20, 2.626),
        (12, 20, 1.0),
        (96, 40, 3.464),
        (200, 3, 6.183),
    ]:
        rates = Rates.of(n, d)
        assert abs(rates.d_sigma - rates.c_sigma - expected) < 1e-3, (n, d)


def test_large_populations_walk_over_steps_in_twenty_dimensions():
    space = Space.vector([-5.0] * 20, [5.0] * 20)
    scales = 10.0 ** jnp.linspace(0.0, 2.0, 20)
    keys = jax.random.split(jax.random.key(1), 8)
    whole = jax.vmap(steps, (0, None))
    runs = minimize_runs(whole, cma_es(48), space, keys, scales, num_steps=250)
    # With the tutorial's damping three of the eight.
    assert (np.asarray(runs.value) == 0.0).sum() >= 7
