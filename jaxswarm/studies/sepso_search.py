"""The contest of the SEPSO study: who takes part, the runs at equal evaluations, the comparisons."""

import dataclasses
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.studies.rx60_search import torque_fitness
from jaxswarm.studies.sepso_plants import Data, Plant, torque_problem
from jaxswarm.studies.statistics import compare, holm, verdict
from jaxswarm.swarm import (
    cma_es,
    de,
    ga,
    minimize_runs,
    polish,
    random_search,
    sepso,
    spso,
    spso2011,
    textbook_ga,
)

PARTICLES = 40
SEPSO = ("SEPSO R1", "SEPSO R2", "SEPSO R3", "SEPSO R1, c = 1.5 (ours)")
RIVALS = ("SPSO", "GA", "textbook GA")
FAST = ("SPSO", "GA", "SEPSO R1")


def contestants(num_steps: int) -> dict[str, Any]:
    """Optimizers by name: the paper's three (SEPSO in all reconstructions), and the yardsticks."""
    first = sepso(PARTICLES, num_steps)
    return {
        "SPSO": spso(PARTICLES),
        "GA": ga(PARTICLES),
        "textbook GA": textbook_ga(PARTICLES),
        "SEPSO R1": first,
        "SEPSO R2": sepso(PARTICLES, num_steps, variant="R2"),
        "SEPSO R3": sepso(PARTICLES, num_steps, variant="R3"),
        "SEPSO R1, c = 1.5 (ours)": dataclasses.replace(first, cognitive=1.5, social=1.5),
        "SPSO 2011": spso2011(PARTICLES),
        "DE": de(PARTICLES),
        "CMA-ES": cma_es(PARTICLES),
        "random search": random_search(PARTICLES),
    }


@dataclasses.dataclass(frozen=True)
class Runs:
    """Final values (runs,), parameters (runs, 4), parameter errors (runs, 4), histories (runs, steps)."""

    values: np.ndarray
    parameters: np.ndarray
    errors: np.ndarray
    history: np.ndarray
    positions: np.ndarray

    @property
    def accuracy(self) -> np.ndarray:
        """RMS of a run's four parameter errors, each as a share of its range, (runs,)."""
        return np.sqrt((self.errors**2).mean(axis=1))


def run_one(
    plant: Plant, fn: Callable, args: Any, optimizer: Any, keys: jax.Array, num_steps: int
) -> Runs:
    """All runs of one optimizer on one plant."""
    result = minimize_runs(fn, optimizer, plant.space, keys, args, num_steps=num_steps)
    parameters = np.asarray(result.params)
    return Runs(
        values=np.asarray(result.value),
        parameters=parameters,
        errors=np.abs(parameters - plant.true) / (plant.upper - plant.lower),
        history=np.asarray(result.history),
        positions=np.asarray(result.position),
    )


def contest(
    plant: Plant, data: Data, keys: jax.Array, num_steps: int, names: tuple[str, ...]
) -> dict[str, Runs]:
    """Output error: every contestant at the same number of evaluations."""
    everyone = contestants(num_steps)
    return {n: run_one(plant, plant.cost, data, everyone[n], keys, num_steps) for n in names}


def torque_contest(
    plant: Plant, keys: jax.Array, num_steps: int, names: tuple[str, ...]
) -> dict[str, Runs]:
    """The same contest with torque error and perfect accelerations."""
    problem = jax.tree.map(jnp.asarray, torque_problem(plant))
    everyone = contestants(num_steps)
    return {n: run_one(plant, torque_fitness, problem, everyone[n], keys, num_steps) for n in names}


def accuracy_rows(found: dict[str, Runs]) -> list[dict]:
    """The accuracy table: parameters, their errors and the cost, per optimizer."""
    return [
        {
            "optimizer": name,
            "reconstruction": name.startswith("SEPSO"),
            "mean": runs.parameters.mean(axis=0).tolist(),
            "std": runs.parameters.std(axis=0, ddof=1).tolist(),
            "error_median": np.median(runs.errors, axis=0).tolist(),
            "accuracy_median": float(np.median(runs.accuracy)),
            "cost_median": float(np.median(runs.values)),
            "cost_max": float(runs.values.max()),
        }
        for name, runs in found.items()
    ]


def comparisons(found: dict[str, Runs]) -> list[dict]:
    """Every SEPSO against every rival: rank test and effect size on cost and on accuracy."""
    rows = []
    for ours in (n for n in SEPSO if n in found):
        for rival in (n for n in RIVALS if n in found):
            for what in ("values", "accuracy"):
                pair = getattr(found[ours], what), getattr(found[rival], what)
                rows.append(
                    {
                        "sepso": ours,
                        "rival": rival,
                        "on": {"values": "cost"}.get(what, what),
                        **compare(*pair),
                    }
                )
    for row, p in zip(rows, holm([row["p"] for row in rows]), strict=True):
        row["p_holm"] = float(p)
        row["sepso_is"] = verdict(p, row["effect"])
    return rows


def polished(plant: Plant, data: Data, runs: Runs, count: int) -> dict:
    """Levenberg-Marquardt from the end of the first ``count`` runs, and of least value among them."""
    values, accuracy, parameters = [], [], []
    for position in runs.positions[:count]:
        found = polish(
            plant.residual,
            plant.space,
            jnp.asarray(position),
            data,
            method="levenberg_marquardt",
            num_steps=100,
        )
        error = (np.asarray(found.params) - plant.true) / (plant.upper - plant.lower)
        values.append(float(found.value))
        accuracy.append(float(np.sqrt((error**2).mean())))
        parameters.append(np.asarray(found.params).tolist())
    best = int(np.argmin(values))
    return {
        "starts": len(values),
        "cost_before_median": float(np.median(runs.values[:count])),
        "cost_median": float(np.median(values)),
        "cost_best": values[best],
        "accuracy_median": float(np.median(accuracy)),
        "parameters_best": parameters[best],
        "accuracy_best": accuracy[best],
    }
