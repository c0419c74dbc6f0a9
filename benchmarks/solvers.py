"""What is compared: every registered optimizer of ours, the peers, and who bears the same name.

A family holds solvers of the same name or of the same rule. Libraries mean different things by "PSO", so
each entry says what it really runs, and for the swarms of the papers the peer is run with their rule.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np

from benchmarks import peers
from benchmarks.peers import NAMES, POPULATION, Solve, by_index, keys_of, small_population
from benchmarks.problems import BOUND
from jaxswarm.swarm import OPTIMIZERS, Space, minimize_runs, ring

W, C = 0.5 / math.log(2.0), 0.5 + math.log(2.0)  # of spso


class Solver(NamedTuple):
    """One line of the comparison: ``build()`` imports its library and returns the solver.

    It is compared with ours, or with the peers, of all its ``families``.
    """

    families: tuple[str, ...]
    rule: str
    build: Callable[[], Solve]


def ours(name: str, **options: Any) -> Solve:
    """One of our optimizers; CMA-ES chooses its own population."""
    entry = OPTIMIZERS[name]

    def solve(problem, instance, evaluations, seeds):
        dims = instance.shift.size
        size = small_population(dims) if name == "cma_es" else POPULATION
        rows = size + 1 if name == "aelspso" else size
        steps = evaluations // rows
        scheduled = {"num_steps": steps} if entry.scheduled else {}
        optimizer = entry.factory(size, **scheduled, **options)
        space = Space.vector([-BOUND] * dims, [BOUND] * dims)
        args = (jnp.int32(NAMES.index(problem)), instance)
        result = minimize_runs(by_index, optimizer, space, keys_of(seeds), args, num_steps=steps)
        return np.asarray(result.value)

    return solve


FAMILY = dict(
    pso="PSO", spso="PSO, rule of spso", gpso="PSO, rule of gpso", ga="GA", textbook_ga="textbook GA",
    de="DE", cma_es="CMA-ES", aelspso="PSO, adaptive", clpso="CLPSO", lshade="L-SHADE", shade="SHADE",
)  # fmt: skip
GPSO_RULE = "w 0.9 to 0.4, c 2, steps limited to 20 %"
SPSO_RULE = f"w {W:.3f}, c {C:.3f}"
APSO = dict(adapt_coefficients=True, gate="convergence", on_failure="replace worst")


def solvers() -> dict[str, Solver]:
    """All solvers by label."""
    table = {
        f"jaxswarm {name}": Solver(
            (FAMILY.get(name, name),), entry.description, lambda name=name: ours(name)
        )
        for name, entry in OPTIMIZERS.items()
    }

    def add(label, family, rule, build, *args, **options):
        table[label] = Solver(tuple(family.split(" and ")), rule, lambda: build(*args, **options))

    _add_swarms(add)
    _add_evolution(add)
    return table


def _add_swarms(add: Callable) -> None:
    """Variants of ours, and the swarms of other packages."""
    for variant in ("R2", "R3"):
        rule = f"variant {variant}"
        add(f"jaxswarm sepso {variant}", "sepso", rule, ours, "sepso", variant=variant)
    add("jaxswarm pso, ring", "PSO, local best", "pso on a ring", ours, "pso", topology=ring())
    add(
        "jaxswarm aelspso, as APSO",
        "PSO, adaptive",
        "options of the 2009 paper",
        ours,
        "aelspso",
        **APSO,
    )

    rest = dict(initial_velocity=0.0)
    add("jaxswarm spso, at rest", "PSO, rule of spso", "starts at rest", ours, "spso", **rest)
    as_mealpy = dict(strategy="rand/1", weight=0.1, crossover_rate=0.9, dither=0.0)
    add("jaxswarm de, as mealpy", "DE", "rand/1/bin, F 0.1, CR 0.9", ours, "de", **as_mealpy)

    rule = "w 0.75, c1 1.5, c2 2, one pair of random numbers a particle, no bounds"
    add("evosax PSO", "PSO", rule, peers.evosax, "PSO")
    rule = "w 0.7298, c 1.49618, periodic walls"
    add("pyswarms GlobalBestPSO", "PSO", rule, peers.pyswarms)
    rule = "APSO: w, c1, c2 by evolutionary state, leader mutated, steps limited to 20 %"
    add("pymoo PSO", "PSO and PSO, adaptive", rule, peers.pymoo, "PSO")
    rule = "w 0.4, c 2.05, a particle moves only where it gets better, redraws outside"
    add("mealpy OriginalPSO", "PSO", rule, peers.mealpy, "swarm_based", "PSO", "OriginalPSO")
    rule = "ring of three, w 0.7298, c 1.49618, periodic walls"
    add("pyswarms LocalBestPSO", "PSO, local best", rule, peers.pyswarms, "LocalBestPSO")
    add(
        "pyswarms as gpso", "PSO, rule of gpso", GPSO_RULE, peers.pyswarms, w=0.9, c=2.0, w_end=0.4,
        velocity_limit=0.2, walls="reflective",
    )  # fmt: skip
    add(
        "pyswarms as spso",
        "PSO, rule of spso",
        SPSO_RULE,
        peers.pyswarms,
        w=W,
        c=C,
        walls="nearest",
    )
    rule = SPSO_RULE + ", one pair of random numbers a particle, no bounds"
    add(
        "evosax as spso", "PSO, rule of spso", rule, peers.evosax, "PSO",
        inertia_coeff=W, cognitive_coeff=C, social_coeff=C,
    )  # fmt: skip
    rule = (
        "a particle moves only where it gets better, velocities and exemplars drawn anew each step"
    )
    add("mealpy CL_PSO", "CLPSO", rule, peers.mealpy, "swarm_based", "PSO", "CL_PSO")


def _add_evolution(add: Callable) -> None:
    """Differential evolution, genetic algorithms and CMA-ES of other packages."""
    rule = "best/1/bin, F 0.5 to 1 a generation, CR 0.7"
    add("scipy differential_evolution", "DE", rule, peers.scipy_de)
    rule = "best/1/bin, F 0.5, CR 0.2, polynomial mutation"
    add("pymoo DE", "DE", rule, peers.pymoo, "DE")
    rule = "best/1/bin, F 0.8, CR 0.9, no bounds"
    add("evosax DifferentialEvolution", "DE", rule, peers.evosax, "DifferentialEvolution")
    evolution = "evolutionary_based"
    add(
        "mealpy OriginalDE",
        "DE",
        "rand/1/bin, F 0.1, CR 0.9",
        peers.mealpy,
        evolution,
        "DE",
        "OriginalDE",
    )
    rule = "success history, shrinking population"
    add("mealpy L_SHADE", "L-SHADE", rule, peers.mealpy, evolution, "SHADE", "L_SHADE")

    rule = "tournament, SBX, polynomial mutation, best of parents and children"
    add("pymoo GA", "GA", rule, peers.pymoo, "GA")
    add(
        "evosax SimpleGA", "GA", "normal mutation of the elite, no bounds", peers.evosax, "SimpleGA"
    )
    rule = "tournament, uniform crossover, redrawn genes"
    add("mealpy BaseGA", "GA", rule, peers.mealpy, evolution, "GA", "BaseGA")
    add("pymoo CMAES", "CMA-ES", "pycma with bounds", peers.pymoo, "CMAES")
    add("evosax CMA_ES", "CMA-ES", "no bounds", peers.evosax, "CMA_ES")
