"""Other libraries, each with its own defaults unless the label says otherwise.

Swarms and evolution start uniformly in [-5, 5]^D and stay there, CMA-ES starts uniformly in [-4, 4]^D
with a step of 2 and no bounds, as its authors run it. Each solver gets a function (``Single``) that raises
when the budget is spent.
"""

import contextlib
import io
import logging
import warnings
from collections.abc import Callable
from functools import cache

import numpy as np

from benchmarks.bbob.problems import BOUND, Single, Spent

Search = Callable[[Single, int, int, int], None]
"""(function, dims, budget, seed)"""


def solve(search: Search, function: Single, dims: int, budget: int, seed: int) -> None:
    """Run one search to its own end or to that of the budget, without a word."""
    silent = contextlib.redirect_stdout(io.StringIO())
    with warnings.catch_warnings(), silent, contextlib.suppress(Spent):
        warnings.simplefilter("ignore")
        search(function, dims, budget, seed)


def pycma(restarts: int, bipop: bool) -> Search:
    """CMA-ES of its author, alone, with IPOP or with BIPOP restarts."""
    import cma

    def search(function, dims, budget, seed):
        draw = np.random.default_rng(seed)
        options = {"verbose": -9, "seed": seed + 1, "maxfevals": budget}
        start = lambda: draw.uniform(-4.0, 4.0, dims)  # noqa: E731
        cma.fmin2(function, start, 2.0, options, restarts=restarts, bipop=bipop)

    return search


def scipy_de() -> Search:
    """Differential evolution of SciPy without its polish and its own end."""
    from scipy.optimize import differential_evolution

    def search(function, dims, budget, seed):
        box = [(-BOUND, BOUND)] * dims
        differential_evolution(function, box, maxiter=budget, tol=0.0, polish=False, rng=seed)

    return search


def pymoo(kind: str, module: str) -> Search:
    """A single-objective algorithm of pymoo."""
    from importlib import import_module

    from pymoo.core.problem import Problem
    from pymoo.optimize import minimize

    build = getattr(import_module(f"pymoo.algorithms.soo.nonconvex.{module}"), kind)

    def search(function, dims, budget, seed):
        class Box(Problem):
            def _evaluate(self, x, out, *args, **kwargs):
                out["F"] = function(x)[:, None]

        problem = Box(n_var=dims, n_obj=1, xl=-BOUND, xu=BOUND)
        minimize(problem, build(), ("n_eval", budget), seed=seed, verbose=False)

    return search


def nevergrad(kind: str) -> Search:
    """An optimizer of nevergrad; NGOpt chooses one by dimension and budget."""
    import nevergrad as ng
    from nevergrad.optimization import metamodel

    # Its surrogate predicts arrays of one number, which NumPy from 2.4 on does not turn into a float.
    metamodel.float = lambda number: float(np.asarray(number).item())

    def search(function, dims, budget, seed):
        box = ng.p.Array(shape=(dims,)).set_bounds(-BOUND, BOUND)
        box.random_state.seed(seed)
        ng.optimizers.registry[kind](parametrization=box, budget=budget).minimize(function)

    return search


def pyswarms() -> Search:
    """Global-best swarm of 50 with constriction coefficients (the library has no default ones)."""
    from pyswarms.single import GlobalBestPSO

    def search(function, dims, budget, seed):
        logging.disable(logging.CRITICAL)
        np.random.seed(seed)
        bounds = np.full(dims, -BOUND), np.full(dims, BOUND)
        options = {"w": 0.7298, "c1": 1.49618, "c2": 1.49618}
        swarm = GlobalBestPSO(50, dims, options, bounds=bounds)
        swarm.optimize(function, iters=budget // 50, verbose=False)

    return search


def evosax(kind: str) -> Search:
    """An algorithm of evosax: CMA-ES with its usual population, others with 50."""
    import evosax.algorithms
    import jax
    import jax.numpy as jnp

    build = getattr(evosax.algorithms, kind)
    by_mean = hasattr(build, "get_mean")

    @cache  # another object would be compiled anew, for every run
    def in_dimensions(dims):
        size = 4 + int(3 * np.log(dims)) if by_mean else 50
        algorithm = build(population_size=size, solution=jnp.zeros(dims))
        return size, algorithm, jax.jit(algorithm.ask), jax.jit(algorithm.tell)

    def search(function, dims, budget, seed):
        size, algorithm, ask, tell = in_dimensions(dims)
        params = algorithm.default_params
        key, key_start, key_run = jax.random.split(jax.random.key(seed), 3)
        if by_mean:
            params = params.replace(std_init=2.0)
            mean = jax.random.uniform(key_start, (dims,), minval=-4.0, maxval=4.0)
            state = algorithm.init(key, mean, params)
        else:
            shape = (size, dims)
            start = jax.random.uniform(key_start, shape, minval=-BOUND, maxval=BOUND)
            state = algorithm.init(key, start, function(start), params)
        for key in jax.random.split(key_run, budget // size):
            population, state = ask(key, state, params)
            state, _ = tell(key, population, jnp.asarray(function(population)), state, params)

    return search


RIVALS: dict[str, Callable[[], Search]] = {
    "pycma": lambda: pycma(0, False),
    "pycma IPOP": lambda: pycma(9, False),
    "pycma BIPOP": lambda: pycma(9, True),
    "scipy DE": scipy_de,
    "pymoo DE": lambda: pymoo("DE", "de"),
    "pymoo PSO": lambda: pymoo("PSO", "pso"),
    "nevergrad NGOpt": lambda: nevergrad("NGOpt"),
    "pyswarms PSO": pyswarms,
    "evosax CMA_ES": lambda: evosax("CMA_ES"),
    "evosax PSO": lambda: evosax("PSO"),
    "evosax DE": lambda: evosax("DifferentialEvolution"),
}
"""Label -> what imports the library and builds the search."""
