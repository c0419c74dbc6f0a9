"""The contest of the SEPSO study: who takes part, the runs at equal evaluations, the comparisons.

Who has no schedule searches the same way whatever its budget, so its shorter search is the beginning of
its longest. Contestants run in parallel threads: compiling and computing both release the interpreter.
"""

import dataclasses
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.studies.rx60.search import torque_fitness
from jaxswarm.studies.sepso.plants import Data, Plant, torque_problem
from jaxswarm.studies.statistics import compare, holm, verdict
from jaxswarm.swarm import (
    cma_es,
    de,
    ga,
    gpso,
    minimize_runs,
    polish,
    random_search,
    sepso,
    spso,
    spso2011,
    textbook_ga,
)

PARTICLES = 40
OURS = "SEPSO (ours)"
SEPSO = ("SEPSO R1", "SEPSO R2", "SEPSO R3", OURS)
SPSO = ("SPSO", "SPSO (w falls)")
GENETIC = ("GA", "textbook GA")
RIVALS = SPSO + GENETIC
FAST = ("SPSO", "GA", "SEPSO R1")
THREADS = 2

Factory = Callable[[int], Any]


def contestants(ours: Factory | None = None) -> dict[str, tuple[Factory, bool]]:
    """Name to (steps -> optimizer, whether it has a schedule): the paper's three and the yardsticks.

    Args:
        ours: Builds the setting of our own for a number of steps; None: it does not take part.
    """
    n = PARTICLES
    fixed: dict[str, Callable[[Any], Any]] = {
        "SPSO": spso,
        "GA": ga,
        "textbook GA": textbook_ga,
        "SPSO 2011": spso2011,
        "DE": de,
        "CMA-ES": cma_es,
        "random search": random_search,
    }
    scheduled: dict[str, Callable[[Any], Any]] = {
        "SPSO (w falls)": lambda steps: gpso(n, steps),
        "SEPSO R1": lambda steps: sepso(n, steps),
        "SEPSO R2": lambda steps: sepso(n, steps, variant="R2"),
        "SEPSO R3": lambda steps: sepso(n, steps, variant="R3"),
    } | ({OURS: ours} if ours else {})
    every: dict[str, tuple[Callable[[Any], Any], bool]] = {
        name: (_unscheduled(make, n), False) for name, make in fixed.items()
    }
    every |= {name: (make, True) for name, make in scheduled.items()}
    order = (*SPSO, *GENETIC, *SEPSO)
    return {name: every[name] for name in sorted(every, key=lambda k: (*order, k).index(k))}


@dataclasses.dataclass(frozen=True)
class Runs:
    """Best values (runs, steps) and their points in the unit cube (runs, steps, 4) of one contestant.

    >>> plant = type("Plant", (), {"lower": np.zeros(1), "upper": np.ones(1), "true": np.ones(1)})
    >>> runs = Runs(plant, np.array([[2.0, 1.0]]), np.array([[[0.5], [0.75]]]))
    >>> runs.accuracy.tolist(), runs.until(1).accuracy.tolist()
    ([0.25], [0.5])
    """

    plant: Plant
    history: np.ndarray
    path: np.ndarray

    def until(self, steps: int) -> "Runs":
        """The beginning of the same search."""
        return dataclasses.replace(self, history=self.history[:, :steps], path=self.path[:, :steps])

    @property
    def values(self) -> np.ndarray:
        """Final values, (runs,)."""
        return self.history[:, -1]

    @property
    def positions(self) -> np.ndarray:
        """Final points in the unit cube, (runs, 4)."""
        return self.path[:, -1]

    @property
    def parameters(self) -> np.ndarray:
        """Final parameters, (runs, 4)."""
        return self.plant.lower + self.positions * (self.plant.upper - self.plant.lower)

    @property
    def errors(self) -> np.ndarray:
        """Parameter errors as shares of the ranges, (runs, 4)."""
        return _errors(self.plant, self.parameters)

    @property
    def accuracy(self) -> np.ndarray:
        """RMS of a run's parameter errors, (runs,)."""
        return np.sqrt((self.errors**2).mean(axis=1))


def _errors(plant, parameters):
    return np.abs(parameters - plant.true) / (plant.upper - plant.lower)


def _record(state, info):
    return info.value_best, state.best_position


def contest(
    plant: Plant,
    fn: Callable,
    args: Any,
    keys: jax.Array,
    budgets: Iterable[int],
    names: Iterable[str],
    ours: Factory | None = None,
) -> dict[int, dict[str, Runs]]:
    """Every contestant at every budget in steps, the same keys for all; equal evaluations.

    Args:
        plant: Whose parameters are searched.
        fn: ``(population (m, 4), args) -> (m,)``.
        args: Data for ``fn``.
        keys: (runs,), one a run.
        budgets: Numbers of steps.
        names: Of :func:`contestants`.
        ours: As there.
    """
    every, budgets = contestants(ours), sorted(budgets)

    def one(task):
        name, steps = task
        result = minimize_runs(
            fn, every[name][0](steps), plant.space, keys, args, num_steps=steps, record=_record
        )
        return Runs(plant, *map(np.asarray, result.history))

    tasks = [(n, b) for n in names for b in (budgets if every[n][1] else budgets[-1:])]
    with ThreadPoolExecutor(THREADS) as pool:
        found = dict(zip(tasks, pool.map(one, tasks), strict=True))
    return {
        b: {n: found[n, b] if (n, b) in found else found[n, budgets[-1]].until(b) for n in names}
        for b in budgets
    }


def torque_contest(plant: Plant, keys: jax.Array, steps: int, names, ours=None) -> dict[str, Runs]:
    """The same contest with torque error and perfect accelerations."""
    problem = jax.tree.map(jnp.asarray, torque_problem(plant))
    return contest(plant, torque_fitness, problem, keys, [steps], names, ours)[steps]


def accuracy_rows(found: dict[str, Runs]) -> list[dict]:
    """The accuracy table: parameters, their errors and the cost, per optimizer."""
    return [
        {
            "optimizer": name,
            "reconstruction": name in (*SEPSO, *SPSO),
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
    for mine in (n for n in SEPSO if n in found):
        for rival in (n for n in RIVALS if n in found):
            for what, label in (("values", "cost"), ("accuracy", "accuracy")):
                test = compare(getattr(found[mine], what), getattr(found[rival], what))
                rows.append({"sepso": mine, "rival": rival, "on": label, **test})
    for row, p in zip(rows, holm([row["p"] for row in rows]), strict=True):
        row["p_holm"] = float(p)
        row["sepso_is"] = verdict(p, row["effect"])
    return rows


def _unscheduled(make: Callable[[Any], Any], n: Any) -> Callable[[Any], Any]:
    """A scheme to which the length of the run means nothing."""
    return lambda steps: make(n)


def polished(plant: Plant, data: Data, runs: Runs) -> dict:
    """Levenberg-Marquardt from the end of every run."""
    options: dict[str, Any] = {"method": "levenberg_marquardt", "num_steps": 100}
    found = jax.vmap(lambda x: polish(plant.residual, plant.space, x, data, **options))(
        jnp.asarray(runs.positions)
    )
    values, parameters = np.asarray(found.value), np.asarray(found.params)
    accuracy = np.sqrt((_errors(plant, parameters) ** 2).mean(axis=1))
    best = int(np.argmin(values))
    return {
        "starts": len(values),
        "at_the_best": int((values <= 1.001 * values[best] + 1e-12).sum()),
        "cost_before_median": float(np.median(runs.values)),
        "cost_median": float(np.median(values)),
        "cost_best": float(values[best]),
        "accuracy_median": float(np.median(accuracy)),
        "parameters_best": parameters[best].tolist(),
        "accuracy_best": float(accuracy[best]),
    }
