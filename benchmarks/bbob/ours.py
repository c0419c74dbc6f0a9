"""Our optimizers on functions of the host: all runs of a dimension in one jitted update.

Runs are lanes of it (``vmap``), but for optimizers that mostly take the cheap side of a branch: lanes
would take both sides of it, so their runs follow one another (``lax.map``).
"""

from collections.abc import Callable
from functools import partial
from inspect import signature
from typing import Any

import jax
import numpy as np

from benchmarks.bbob.problems import BOUND, Record
from jaxswarm.swarm import OPTIMIZERS, fold, restart
from jaxswarm.swarm.schedules import for_run

Build = Callable[[int], Any]


def _defaults(factory: Callable[..., Any]) -> Build:
    """Build with defaults, but for the number of evaluations where that is asked for."""
    asked = "num_evaluations" in signature(factory).parameters
    return lambda budget: factory(num_evaluations=budget) if asked else factory()


OURS: dict[str, Build] = {
    **{f"jaxswarm {name}": _defaults(entry.factory) for name, entry in OPTIMIZERS.items()},
    "jaxswarm restart(cma_es)": lambda budget: restart(OPTIMIZERS["cma_es"].factory()),
}
"""Label -> what builds the optimizer for a number of evaluations, with its defaults."""


def solve(build: Build, record: Record, dims: int, seeds: np.ndarray) -> None:
    """Run until the budget is spent or all targets are reached, by asking and telling.

    Args:
        build: Makes the optimizer for a number of evaluations.
        record: Its problems are the runs.
        dims: Of all problems.
        seeds: One a run.
    """
    keys = jax.vmap(jax.random.key)(np.asarray(seeds, np.uint32))
    optimizer = build(record.budget)
    state = jax.jit(jax.vmap(lambda key: optimizer.init(key, dims)))(keys)
    candidates = state.position.shape[1]
    steps = max(1, record.budget // candidates)
    optimizer = for_run(optimizer, float(steps))

    def update(run):
        key, state, value = run
        return optimizer.update(fold(key, state.count), state, value)[0]

    over = partial(jax.lax.map, update) if _branches(state) else jax.vmap(update)
    update_all = jax.jit(lambda *runs: over(runs), donate_argnums=1)
    for _ in range(steps):
        value = record.evaluate((2.0 * np.asarray(state.position) - 1.0) * BOUND)
        if record.solved.all():
            return
        state = update_all(keys, state, value)


def _branches(state: Any) -> bool:
    """Whether updates differ much in what they cost."""
    return hasattr(state, "pool")
