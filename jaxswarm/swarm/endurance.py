"""Long after a population has collapsed: thousands of updates, without a NaN.

What is divided by a spread, a step size or a difference of values is sound for some hundred updates and
fails once these have shrunk to rounding, so only a long run shows it. The problems are lanes of one
program: a sphere, which converges; a constant and a plateau, on which nothing can be told apart; a sphere
without values (NaN, infinite) in the half of the cube in which its center lies; and no value anywhere.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.swarm.random import fold
from jaxswarm.swarm.schedules import for_run

__all__ = ["NUM_UPDATES", "PROBLEMS", "Endured", "endure", "faults"]

NUM_UPDATES = 10_000
"""A population collapses within hundreds of updates; what drifts from then on shows by some thousand."""
CENTER, WALL = 0.63, 0.5
"""Of the sphere in every coordinate, and where the halves meet."""
PLATEAU = 0.1
"""Half the side of the square around the middle of the cube in which all values are zero."""
CONSTANT = 7.0
PROBLEMS = {
    "sphere": 0.0,
    "constant": CONSTANT,
    "half NaN": (CENTER - WALL) ** 2,
    "half infinite": (CENTER - WALL) ** 2,
    "flat at zero": 0.0,
    "no value anywhere": np.inf,
}
"""Name of each lane and the lowest value that exists there."""


class Endured(NamedTuple):
    """What the long runs left behind, with a leading axis of lanes, one a problem.

    Attributes:
      state: the last states.
      best: (lanes, updates) best values.
      inside: (lanes, updates) whether all candidates lay in the cube.
      told: (lanes, updates) whether all numbers for observers were numbers; the mean value may be none.
    """

    state: Any
    best: jax.Array
    inside: jax.Array
    told: jax.Array


def endure(
    optimizer: Any, num_dims: int, key: jax.Array, dtype: Any, num_updates: int = NUM_UPDATES
) -> Endured:
    """Run an optimizer for ``num_updates`` on every problem."""
    optimizer = for_run(optimizer, float(num_updates))

    def search(which):
        def step(state, _):
            value = _values(state.position)[which]
            state, info = optimizer.update(fold(key, state.count), state, value)
            inside = jnp.all((state.position >= 0.0) & (state.position <= 1.0))
            numbers = [*jax.tree.leaves(info.hyper), info.diversity]
            told = ~jnp.any(jnp.stack([jnp.any(jnp.isnan(number)) for number in numbers]))
            return state, (state.best_value, inside, told)

        state, kept = jax.lax.scan(
            step, optimizer.init(key, num_dims, dtype=dtype), length=num_updates
        )
        return Endured(state, *kept)

    return jax.jit(jax.vmap(search))(jnp.arange(len(PROBLEMS)))


def faults(runs: Endured) -> list[str]:
    """Sentences on what did not hold in the long runs, none if all did."""
    found = []
    for lane, (name, lowest) in enumerate(PROBLEMS.items()):
        state, best, inside, told = jax.tree.map(lambda leaf, i=lane: np.asarray(leaf[i]), runs)
        broken = [
            f"state{jax.tree_util.keystr(path)} holds NaN"
            for path, leaf in jax.tree_util.tree_flatten_with_path(state)[0]
            if np.issubdtype(leaf.dtype, np.inexact) and np.isnan(leaf).any()
        ]
        if not inside.all():
            broken.append(f"a candidate left the cube in update {np.argmin(inside) + 1}")
        if not told.all():
            broken.append(f"info holds NaN from update {np.argmin(told) + 1} on")
        if (best[1:] > best[:-1]).any():
            broken.append("the best value rose")
        if np.isfinite(best[-1]) != np.isfinite(lowest):
            broken.append(f"the best value is {best[-1]}")
        found += [f"{name}, after {best.size} updates: {sentence}" for sentence in broken]
    return found


def _values(position):
    """Values (lanes, n) of all problems, in the order of ``PROBLEMS``."""
    sphere = jnp.sum((position - CENTER) ** 2, axis=-1)
    absent = position[:, 0] > WALL
    plateau = jnp.sum(jnp.maximum(jnp.abs(position - 0.5) - PLATEAU, 0.0), axis=-1)
    return jnp.stack(
        [
            sphere,
            jnp.full_like(sphere, CONSTANT),
            jnp.where(absent, jnp.nan, sphere),
            jnp.where(absent, jnp.inf, sphere),
            plateau,
            jnp.full_like(sphere, jnp.nan),
        ]
    )
