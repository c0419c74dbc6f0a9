"""Our optimizers on functions of the host: all runs of a dimension are lanes of one jitted update."""

from collections.abc import Callable
from typing import Any

import jax
import numpy as np

from benchmarks.bbob.problems import BOUND, Record
from jaxswarm.swarm import OPTIMIZERS, fold, restart
from jaxswarm.swarm.schedules import for_run

Build = Callable[[], Any]

OURS: dict[str, Build] = {
    **{f"jaxswarm {name}": entry.factory for name, entry in OPTIMIZERS.items()},
    "jaxswarm restart(cma_es)": lambda: restart(OPTIMIZERS["cma_es"].factory()),
}
"""Label -> what builds the optimizer with its defaults."""


def solve(build: Build, record: Record, dims: int, seeds: np.ndarray) -> None:
    """Run until the budget is spent or all targets are reached, by asking and telling.

    Args:
        build: Makes the optimizer.
        record: Its problems are the runs.
        dims: Of all problems.
        seeds: One a run.
    """
    keys = jax.vmap(jax.random.key)(np.asarray(seeds, np.uint32))
    optimizer = build()
    state = jax.jit(jax.vmap(lambda key: optimizer.init(key, dims)))(keys)
    candidates = state.position.shape[1]
    steps = max(1, record.budget // candidates)
    optimizer = for_run(optimizer, float(steps))

    def update(key, state, value):
        return optimizer.update(fold(key, state.count), state, value)[0]

    update = jax.jit(jax.vmap(update), donate_argnums=1)
    for _ in range(steps):
        value = record.evaluate((2.0 * np.asarray(state.position) - 1.0) * BOUND)
        if record.solved.all():
            return
        state = update(keys, state, value)
