"""One search of given size by ours and by each peer, as functions that ``throughput`` times.

All evaluate the same sphere, vectorized, and make as many updates. Swarms and populations have n members
everywhere, CMA-ES n samples.
"""

from collections.abc import Callable
from typing import Any

OURS = {"PSO": "pso", "DE": "de", "CMA-ES": "cma_es", "L-SHADE": "lshade"}
EVOSAX = {"PSO": "PSO", "DE": "DifferentialEvolution", "CMA-ES": "CMA_ES"}
"""Algorithm -> name in the library; evosax has no L-SHADE."""


def sphere(x: Any) -> Any:
    """Values (...,) of points (..., d)."""
    return ((x - 0.3) ** 2).sum(axis=-1)


def ours(algorithm: str, n: int, dims: int, runs: int, steps: int, source: str) -> Callable:
    """A search of ours with random numbers from ``source``."""
    import jax

    from jaxswarm import swarm

    # As in the peers, all follow the best of all.
    parts = {"topology": swarm.global_best()} if algorithm == "PSO" else {}
    optimizer = getattr(swarm, OURS[algorithm])(n, random=source, **parts)
    space = swarm.Space.vector([0.0] * dims, [1.0] * dims)
    keys = jax.random.split(jax.random.key(0), runs)

    def objective(x, _):  # a new function: every call of ours compiles for itself
        return sphere(x)

    if runs == 1:
        options = dict(num_steps=steps, vectorized=True)
        return lambda: swarm.minimize(objective, optimizer, space, keys[0], **options).value
    return lambda: swarm.minimize_runs(objective, optimizer, space, keys, num_steps=steps).value


def peers(algorithm: str, n: int, dims: int, runs: int, steps: int) -> dict[str, Callable]:
    """Searches of the peers that have the algorithm and are installed."""
    builds: dict[str, Callable] = {}
    if algorithm in EVOSAX:
        builds["evosax"] = lambda: evosax(EVOSAX[algorithm], n, dims, runs, steps)
    # The others make one run after the other: nothing new to learn of a thousand, and minutes of waiting.
    if algorithm == "PSO" and runs == 1:
        builds["pyswarms"] = lambda: pyswarms(n, dims, steps)
        builds["pagmo"] = lambda: pagmo(n, dims, steps)
    calls = {}
    for name, build in builds.items():
        try:
            calls[name] = build()
        except ImportError:
            continue
    return calls


def evosax(kind: str, n: int, dims: int, runs: int, steps: int) -> Callable:
    """All runs in one compiled scan of ask and tell."""
    import evosax.algorithms
    import jax
    import jax.numpy as jnp

    algorithm = getattr(evosax.algorithms, kind)(population_size=n, solution=jnp.zeros(dims))
    params = algorithm.default_params

    def start(key):
        if hasattr(algorithm, "get_mean"):
            return algorithm.init(
                key, jax.random.uniform(key, (dims,)), params.replace(std_init=0.3)
            )
        population = jax.random.uniform(key, (n, dims))
        return algorithm.init(key, population, sphere(population), params)

    def run(key):
        key_init, key_run = jax.random.split(key)

        def step(state, key):
            population, state = algorithm.ask(key, state, params)
            state, _ = algorithm.tell(key, population, sphere(population), state, params)
            return state, state.best_fitness

        return jax.lax.scan(step, start(key_init), jax.random.split(key_run, steps))[1]

    keys = jax.random.split(jax.random.key(0), runs)
    mapped = jax.jit(jax.vmap(run) if runs > 1 else lambda keys: run(keys[0]))
    return lambda: mapped(keys)


def pyswarms(n: int, dims: int, steps: int) -> Callable:
    """Its global-best swarm."""
    import logging

    import numpy as np
    from pyswarms.single import GlobalBestPSO

    logging.disable(logging.CRITICAL)
    options = {"c1": 1.49618, "c2": 1.49618, "w": 0.7298}
    bounds = (np.zeros(dims), np.ones(dims))

    def run():
        swarm = GlobalBestPSO(n, dims, options, bounds=bounds)
        swarm.optimize(sphere, iters=steps, verbose=False)

    return run


def pagmo(n: int, dims: int, steps: int) -> Callable:
    """Its generational swarm."""
    import numpy as np
    import pygmo

    class Sphere:
        def batch_fitness(self, x):
            return sphere(x.reshape(-1, dims))

        def fitness(self, x):
            return [sphere(np.asarray(x))]

        def get_bounds(self):
            return [0.0] * dims, [1.0] * dims

    def run():
        population = pygmo.population(pygmo.problem(Sphere()), n, seed=0)
        algorithm = pygmo.pso_gen(gen=steps)
        algorithm.set_bfe(pygmo.bfe())
        pygmo.algorithm(algorithm).evolve(population)

    return run
