r"""A setting of SEPSO's own ideas, searched with seeds of its own: coefficients, emotions, elite exchange.

The rule stays R1. Searched are the inertia's ends, c1, c2, the repulsion c3, how fast an emotion fades, the
velocity limit, and whether the swarm is one or four subpopulations that hand their best on. The settings
are drawn at random, a whole draw is one program, and the score of a setting at a budget is its weakest
comparison,

.. math:: \min_{\text{plant, rival}} A_{12}(\text{accuracy of the setting}, \text{of the rival}),

over noise-free data. What wins here is confirmed in the contest, on other keys and on noise it has not
seen; the score itself is the largest of many and says little. It is ours and not the paper's.
"""

import dataclasses
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.studies.sepso.plants import PLANTS, make_data
from jaxswarm.studies.sepso.search import GENETIC, PARTICLES, SPSO, THREADS, Runs, contest
from jaxswarm.studies.statistics import effect_size
from jaxswarm.swarm import islands, minimize_runs, sepso
from jaxswarm.swarm.schedules import linear

SUBPOPULATIONS, EXCHANGE_EVERY = 4, 5
STRUCTURES = ("one swarm", f"{SUBPOPULATIONS} subpopulations, elite exchange")
RIVALS = (*SPSO, GENETIC[0])


def draw(count: int, seed: int) -> dict[str, np.ndarray]:
    """Random settings, (count,) each."""
    rng = np.random.default_rng([seed, 6])
    start = rng.uniform(0.3, 0.9, count)
    return {
        "inertia_start": start,
        "inertia_end": start * rng.uniform(0.2, 1.0, count),
        "cognitive": rng.uniform(0.5, 2.5, count),
        "social": rng.uniform(0.5, 2.5, count),
        "repulsion": np.where(rng.random(count) < 0.4, 0.0, 10.0 ** rng.uniform(-2, 0, count)),
        "decay": 10.0 ** rng.uniform(-2.0, -0.3, count),
        "velocity_limit": rng.choice([0.1, 0.2, 0.5, 1.0], count),
    }


def build(structure: str, setting: dict[str, Any], num_steps: int) -> Any:
    """SEPSO R1 with a setting, as one swarm or as subpopulations.

    >>> setting = {k: v[0] for k, v in draw(1, 0).items()}
    >>> build(STRUCTURES[1], setting, 10).inner.num_particles
    10
    """
    whole = structure == STRUCTURES[0]
    swarm = sepso(PARTICLES if whole else PARTICLES // SUBPOPULATIONS, num_steps)
    swarm = dataclasses.replace(
        swarm,
        inertia=linear(setting["inertia_start"], setting["inertia_end"], num_steps),
        cognitive=setting["cognitive"],
        social=setting["social"],
        velocity_limit=setting["velocity_limit"],
        rule=dataclasses.replace(swarm.rule, repulsion=setting["repulsion"]),
        control=dataclasses.replace(swarm.control, decay=setting["decay"]),
    )
    return swarm if whole else islands(swarm, SUBPOPULATIONS, migrate_every=EXCHANGE_EVERY)


@partial(jax.jit, static_argnames=("name", "structure", "num_steps"))
def _parameters(name, structure, num_steps, settings, keys, data):
    """Final parameters of every setting and run, (settings, runs, 4)."""
    plant = PLANTS[name]

    def one(setting):
        optimizer = build(structure, setting, num_steps)
        options = {"num_steps": num_steps}
        return minimize_runs(plant.cost, optimizer, plant.space, keys, data, **options).params

    return jax.vmap(one)(settings)


def find(
    seed: int, budgets: tuple[int, ...], count: int, runs: int
) -> tuple[dict[int, dict], Callable[[int], Any]]:
    """Search both structures for each budget: what was found, and the factory of the best settings.

    Args:
        seed: Draws the settings and the keys; none of the contest's keys are used.
        budgets: In steps.
        count: Settings a structure.
        runs: Runs of a setting; the rivals have 30.

    The factory takes a number of steps and builds the setting of the nearest budget.
    """
    keys = jax.random.split(jax.random.fold_in(jax.random.key(seed), 6), 30)
    settings = draw(count, seed)
    given = {k: jnp.asarray(v) for k, v in settings.items()}
    data = {name: make_data(plant) for name, plant in PLANTS.items()}
    rivals: dict[str, dict[int, dict[str, Runs]]] = {
        name: contest(plant, plant.cost, data[name], keys, budgets, RIVALS)
        for name, plant in PLANTS.items()
    }

    def accuracy(task):
        structure, name, steps = task
        plant = PLANTS[name]
        found = np.asarray(_parameters(name, structure, steps, given, keys[:runs], data[name]))
        return np.sqrt((((found - plant.true) / (plant.upper - plant.lower)) ** 2).mean(axis=-1))

    tasks = [(s, name, b) for s in STRUCTURES for name in PLANTS for b in budgets]
    with ThreadPoolExecutor(THREADS) as pool:
        found = dict(zip(tasks, pool.map(accuracy, tasks), strict=True))

    reports, chosen = {}, {}
    for steps in budgets:
        scores = {
            structure: np.array(
                [
                    min(
                        effect_size(
                            found[structure, name, steps][k], rivals[name][steps][r].accuracy
                        )
                        for name in PLANTS
                        for r in RIVALS
                    )
                    for k in range(count)
                ]
            )
            for structure in STRUCTURES
        }
        structure = max(STRUCTURES, key=lambda s: scores[s].max())
        best = int(scores[structure].argmax())
        setting = {k: float(v[best]) for k, v in settings.items()}
        chosen[steps] = structure, setting
        reports[steps] = {
            "settings_a_structure": count,
            "runs": runs,
            "structure": structure,
            "setting": setting,
            "weakest_effect": float(scores[structure][best]),
            "best_of_each_structure": {s: float(v.max()) for s, v in scores.items()},
            "ahead_of_all_rivals": {s: int((v > 0.5).sum()) for s, v in scores.items()},
        }

    def factory(num_steps):
        return build(*chosen[min(chosen, key=lambda b: abs(b - num_steps))], num_steps)

    return reports, factory
