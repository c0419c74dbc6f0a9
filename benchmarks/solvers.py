"""Ours and the peers behind one signature: ``solve(problem, instance, evaluations, seeds) -> values``.

All start uniformly in [-5, 5]^D with populations of 50 (where a population can be chosen), keep their own
defaults otherwise, and get the same number of evaluations. Peers without bounds are evaluated at the
nearest point inside.
"""

import logging
import warnings
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.problems import BOUND, PROBLEMS, Instance, evaluate
from jaxswarm.swarm import OPTIMIZERS, Space, minimize_runs

POPULATION = 50
NAMES = tuple(PROBLEMS)

Solve = Callable[[str, Instance, int, int], np.ndarray]


def by_index(x: jax.Array, args: Any) -> jax.Array:
    """Any of the problems in one program: which one is an argument, so nothing compiles anew."""
    index, instance = args
    branches = [lambda x, i, name=name: evaluate(name, x, i, jnp) for name in NAMES]
    return jax.lax.switch(index, branches, x, instance)


def ours(name: str, **options: Any) -> Solve:
    """One of our optimizers; CMA-ES chooses its own population."""
    entry = OPTIMIZERS[name]

    def solve(problem, instance, evaluations, seeds):
        dims = instance.shift.size
        size = 4 + int(3 * np.log(dims)) if name == "cma_es" else POPULATION
        rows = size + 1 if name == "aelspso" else size
        steps = evaluations // rows
        scheduled = {"num_steps": steps} if entry.scheduled else {}
        optimizer = entry.factory(size, **scheduled, **options)
        space = Space.vector([-BOUND] * dims, [BOUND] * dims)
        keys = jax.random.split(jax.random.key(1), seeds)
        args = (jnp.int32(NAMES.index(problem)), instance)
        result = minimize_runs(by_index, optimizer, space, keys, args, num_steps=steps)
        return np.asarray(result.value)

    return solve


def evosax(name: str) -> Solve:
    """An evosax algorithm with its default parameters."""
    import evosax.algorithms as algorithms

    kind = getattr(algorithms, name)

    def solve(problem, instance, evaluations, seeds):
        dims = instance.shift.size
        size = 4 + int(3 * np.log(dims)) if name == "CMA_ES" else POPULATION
        known = (name, dims, evaluations)
        if known not in _COMPILED:
            algorithm = kind(population_size=size, solution=jnp.zeros(dims))
            _COMPILED[known] = jax.jit(
                lambda keys, args: jax.vmap(lambda k: run(algorithm, size, evaluations, k, args))(
                    keys
                )
            )
        args = (jnp.int32(NAMES.index(problem)), instance)
        return np.asarray(_COMPILED[known](jax.random.split(jax.random.key(1), seeds), args))

    def run(algorithm, size, evaluations, key, args):
        dims = args[1].shift.size
        params = algorithm.default_params
        key_init, key_run = jax.random.split(key)
        value = lambda x: by_index(jnp.clip(x, -BOUND, BOUND), args)  # noqa: E731
        if hasattr(algorithm, "get_mean"):
            mean = jax.random.uniform(key_init, (dims,), minval=-BOUND, maxval=BOUND)
            params = params.replace(std_init=0.3 * 2.0 * BOUND)
            state, first, steps = (
                algorithm.init(key_init, mean, params),
                jnp.inf,
                evaluations // size,
            )
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


_COMPILED: dict[Any, Any] = {}


def one_by_one(search: Callable[[Callable, int, int, int], None]) -> Solve:
    """A peer that runs seed after seed: the best value within the budget is recorded here."""

    def solve(problem, instance, evaluations, seeds):
        def single(seed):
            best, spent = np.inf, 0

            def values_of(x):
                nonlocal best, spent
                x = np.clip(np.atleast_2d(x), -BOUND, BOUND)
                values = evaluate(problem, x, instance)
                counted = values[: max(0, evaluations - spent)]
                best, spent = min(best, counted.min(initial=np.inf)), spent + len(values)
                return values

            search(values_of, instance.shift.size, evaluations, seed)
            return best

        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return np.array([single(seed) for seed in range(seeds)])

    return solve


def pyswarms() -> Solve:
    from pyswarms.single import GlobalBestPSO

    logging.disable(logging.CRITICAL)

    def search(values_of, dims, evaluations, seed):
        np.random.seed(seed)
        bounds = (np.full(dims, -BOUND), np.full(dims, BOUND))
        options = {"c1": 1.49618, "c2": 1.49618, "w": 0.7298}
        swarm = GlobalBestPSO(POPULATION, dims, options, bounds=bounds)
        swarm.optimize(values_of, iters=evaluations // POPULATION, verbose=False)

    return one_by_one(search)


def scipy_de() -> Solve:
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
    from importlib import import_module

    from pymoo.core.problem import Problem
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
            algorithm = kind(pop_size=POPULATION)
        minimize(problem, algorithm, ("n_eval", evaluations), seed=seed, verbose=False)

    return one_by_one(search)


def mealpy(module: str, name: str) -> Solve:
    from importlib import import_module

    from mealpy import FloatVar

    package = {"PSO": "swarm_based", "GA": "evolutionary_based", "DE": "evolutionary_based"}
    package["SHADE"] = "evolutionary_based"
    kind = getattr(import_module(f"mealpy.{package[module]}.{module}"), name)

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


def solvers() -> dict[str, tuple[str, Callable[[], Solve]]]:
    """Label -> (family, builder); a family holds what bears the same name."""
    family = dict(
        pso="PSO", spso="PSO", gpso="PSO", ga="GA", textbook_ga="GA", de="DE", cma_es="CMA-ES",
        clpso="CLPSO", lshade="L-SHADE", shade="SHADE",
    )  # fmt: skip
    table = {
        f"jaxswarm {name}": (family.get(name, name), lambda name=name: ours(name))
        for name in OPTIMIZERS
    }
    for variant in ("R2", "R3"):
        build = lambda variant=variant: ours("sepso", variant=variant)  # noqa: E731
        table[f"jaxswarm sepso {variant}"] = ("sepso", build)
    table |= {
        "evosax PSO": ("PSO", lambda: evosax("PSO")),
        "evosax DifferentialEvolution": ("DE", lambda: evosax("DifferentialEvolution")),
        "evosax SimpleGA": ("GA", lambda: evosax("SimpleGA")),
        "evosax CMA_ES": ("CMA-ES", lambda: evosax("CMA_ES")),
        "pyswarms GlobalBestPSO": ("PSO", pyswarms),
        "scipy differential_evolution": ("DE", scipy_de),
        "pymoo PSO": ("PSO", lambda: pymoo("PSO")),
        "pymoo DE": ("DE", lambda: pymoo("DE")),
        "pymoo GA": ("GA", lambda: pymoo("GA")),
        "pymoo CMAES": ("CMA-ES", lambda: pymoo("CMAES")),
        "mealpy OriginalPSO": ("PSO", lambda: mealpy("PSO", "OriginalPSO")),
        "mealpy CL_PSO": ("CLPSO", lambda: mealpy("PSO", "CL_PSO")),
        "mealpy OriginalDE": ("DE", lambda: mealpy("DE", "OriginalDE")),
        "mealpy BaseGA": ("GA", lambda: mealpy("GA", "BaseGA")),
        "mealpy OriginalSHADE": ("SHADE", lambda: mealpy("SHADE", "OriginalSHADE")),
        "mealpy L_SHADE": ("L-SHADE", lambda: mealpy("SHADE", "L_SHADE")),
    }
    return table
