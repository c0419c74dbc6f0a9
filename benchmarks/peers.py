"""Other libraries behind one signature: ``solve(problem, instance, evaluations, seeds) -> values``.

All start uniformly in [-5, 5]^D with populations of 50 (where a population can be chosen), keep their own
defaults unless an argument says otherwise, and get the same number of evaluations. Peers without bounds
are evaluated at the nearest point inside.
"""

import logging
import warnings
from collections.abc import Callable
from importlib import import_module
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.problems import BOUND, PROBLEMS, Instance, evaluate

POPULATION = 50
NAMES = tuple(PROBLEMS)

Solve = Callable[[str, Instance, int, np.ndarray], np.ndarray]


def by_index(x: jax.Array, args: Any) -> jax.Array:
    """Any of the problems in one program: which one is an argument, so nothing compiles anew."""
    index, instance = args
    branches = [lambda x, i, name=name: evaluate(name, x, i, jnp) for name in NAMES]
    return jax.lax.switch(index, branches, x, instance)


def small_population(dims: int) -> int:
    """The default population of CMA-ES."""
    return 4 + int(3 * np.log(dims))


def keys_of(seeds: np.ndarray) -> jax.Array:
    """One JAX key a seed."""
    return jax.vmap(jax.random.key)(jnp.asarray(seeds, jnp.uint32))


def evosax(name: str, **coefficients: float) -> Solve:
    """An evosax algorithm with its default parameters, or with other ``coefficients``."""
    kind = getattr(import_module("evosax.algorithms"), name)
    compiled: dict[Any, Callable] = {}

    def solve(problem, instance, evaluations, seeds):
        dims = instance.shift.size
        size = small_population(dims) if name == "CMA_ES" else POPULATION
        if (dims, evaluations) not in compiled:
            algorithm = kind(population_size=size, solution=jnp.zeros(dims))
            one = lambda key, args: run(algorithm, size, evaluations, key, args)  # noqa: E731
            compiled[dims, evaluations] = jax.jit(jax.vmap(one, in_axes=(0, None)))
        args = (jnp.int32(NAMES.index(problem)), instance)
        return np.asarray(compiled[dims, evaluations](keys_of(seeds), args))

    def run(algorithm, size, evaluations, key, args):
        dims = args[1].shift.size
        params = algorithm.default_params.replace(**coefficients)
        key_init, key_run = jax.random.split(key)
        value = lambda x: by_index(jnp.clip(x, -BOUND, BOUND), args)  # noqa: E731
        if hasattr(algorithm, "get_mean"):
            mean = jax.random.uniform(key_init, (dims,), minval=-BOUND, maxval=BOUND)
            params = params.replace(std_init=0.3 * 2.0 * BOUND)
            state, first = algorithm.init(key_init, mean, params), jnp.inf
            steps = evaluations // size
        else:
            start = jax.random.uniform(key_init, (size, dims), minval=-BOUND, maxval=BOUND)
            first = value(start)
            state, steps = algorithm.init(key_init, start, first, params), evaluations // size - 1

        def step(carry, key):
            state, best = carry
            population, state = algorithm.ask(key, state, params)
            values = value(population)
            state, _ = algorithm.tell(key, population, values, state, params)
            return (state, jnp.minimum(best, jnp.nanmin(values))), None

        keys = jax.random.split(key_run, steps)
        return jax.lax.scan(step, (state, jnp.min(first)), keys)[0][1]

    return solve


def one_by_one(search: Callable[[Callable, int, int, int], None]) -> Solve:
    """A peer that runs seed after seed: the best value within the budget is recorded here."""

    def solve(problem, instance, evaluations, seeds):
        def single(seed):
            best, spent = np.inf, 0

            def values_of(x):
                nonlocal best, spent
                x = np.minimum(np.maximum(np.atleast_2d(x), -BOUND), BOUND)
                values = evaluate(problem, x, instance)
                counted = values[: max(0, evaluations - spent)]
                best, spent = min(best, counted.min(initial=np.inf)), spent + len(values)
                return values

            search(values_of, instance.shift.size, evaluations, int(seed))
            return best

        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return np.array([single(seed) for seed in seeds])

    return solve


def pyswarms(
    name: str = "GlobalBestPSO",
    w: float = 0.7298,
    c: float = 1.49618,
    w_end: float | None = None,
    velocity_limit: float | None = None,
    walls: str = "periodic",
) -> Solve:
    """A swarm of pyswarms (walls: its default); ``w_end`` lets the inertia fall linearly.

    ``velocity_limit`` is in units of the range. A local best is that of a ring of three.
    """
    kind = getattr(import_module("pyswarms.single"), name)
    logging.disable(logging.CRITICAL)

    def search(values_of, dims, evaluations, seed):
        np.random.seed(seed)
        options: dict[str, Any] = {"w": w, "c1": c, "c2": c}
        if name == "LocalBestPSO":
            options |= {"k": 3, "p": 2}
        limit = None if velocity_limit is None else 2.0 * BOUND * velocity_limit
        swarm = kind(
            POPULATION,
            dims,
            options,
            bounds=(np.full(dims, -BOUND), np.full(dims, BOUND)),
            oh_strategy=None if w_end is None else {"w": "lin_variation"},
            velocity_clamp=None if limit is None else (-limit, limit),
            bh_strategy=walls,
        )
        assert w_end in (None, 0.4), "the end of pyswarms' schedule"
        swarm.optimize(values_of, iters=evaluations // POPULATION, verbose=False)

    return one_by_one(search)


def scipy_de() -> Solve:
    """SciPy's differential evolution without its polish, one generation at a time."""
    from scipy.optimize import differential_evolution

    def search(values_of, dims, evaluations, seed):
        start = np.random.default_rng(seed).uniform(-BOUND, BOUND, (POPULATION, dims))
        differential_evolution(
            lambda x: values_of(x.T),
            [(-BOUND, BOUND)] * dims,
            maxiter=evaluations // POPULATION - 1,
            init=start,
            seed=seed,
            polish=False,
            tol=0.0,
            vectorized=True,
            updating="deferred",
        )

    return one_by_one(search)


def pymoo(name: str) -> Solve:
    """An algorithm of pymoo."""
    from pymoo.core.problem import Problem
    from pymoo.operators.sampling.rnd import FloatRandomSampling
    from pymoo.optimize import minimize

    kind = getattr(import_module(f"pymoo.algorithms.soo.nonconvex.{name.lower()}"), name)

    def search(values_of, dims, evaluations, seed):
        class Box(Problem):
            def _evaluate(self, x, out, *args, **kwargs):
                out["F"] = values_of(x)[:, None]

        problem = Box(n_var=dims, n_obj=1, xl=-BOUND, xu=BOUND)
        if name == "CMAES":
            start = np.random.default_rng(seed).uniform(-BOUND, BOUND, dims)
            algorithm = kind(x0=start, sigma=0.3)
        else:
            algorithm = kind(pop_size=POPULATION, sampling=FloatRandomSampling())
        minimize(problem, algorithm, ("n_eval", evaluations), seed=seed, verbose=False)

    return one_by_one(search)


def mealpy(folder: str, module: str, name: str) -> Solve:
    """An algorithm of mealpy."""
    from mealpy import FloatVar

    kind = getattr(import_module(f"mealpy.{folder}.{module}"), name)

    def search(values_of, dims, evaluations, seed):
        problem = {
            "obj_func": lambda x: float(values_of(x)[0]),
            "bounds": FloatVar(lb=[-BOUND] * dims, ub=[BOUND] * dims),
            "minmax": "min",
            "log_to": None,
        }
        model = kind(epoch=max(1, evaluations // POPULATION - 1), pop_size=POPULATION)
        model.solve(problem, seed=seed)

    return one_by_one(search)
