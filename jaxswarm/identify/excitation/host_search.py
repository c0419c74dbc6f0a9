"""A search of values that NumPy computes, so that its steps are no program of JAX."""

from collections.abc import Callable

import jax
import numpy as np

from jaxswarm.swarm import cma_es

# Steps after which progress is told.
_TOLD = 10


def search_on_host(
    values: Callable[[np.ndarray], np.ndarray],
    size: int,
    seed: int,
    runs: int,
    num_steps: int,
    progress: Callable[[str], None],
) -> tuple[np.ndarray, int]:
    """The best point (size,) of several searches in [-1, 1], and how many points were tried.

    ``values`` takes points (n, size) and is no program of JAX.
    """
    optimizer = cma_es()
    update = jax.jit(optimizer.update)
    best, least, tried = np.zeros(size), np.inf, 0
    for run, key in enumerate(jax.random.split(jax.random.key(seed), runs), 1):
        state = optimizer.init(key, size)
        for step in range(num_steps):
            if step % _TOLD == 0:
                progress(
                    f"searching the motion that separates: run {run}, step {step} of {num_steps}"
                )
            population = 2.0 * np.asarray(state.position) - 1.0
            value = values(population)
            tried += len(population)
            if value.min() < least:
                least, best = value.min(), population[value.argmin()]
            key, own = jax.random.split(key)
            state, _ = update(own, state, value)
    return best, tried
