"""How many members and trials L-SHADE has: by the dimensions, and by the length of the run.

The published population, 18 a dimension, is meant for 10,000 evaluations a dimension. With 1,000 it left
BBOB's functions in 5-D at 0.61 of their targets instead of 0.73, with 100 at 0.13 instead of 0.20: a run
begins with the root of the share of these evaluations that it has.
"""

from typing import Any

import jax
import jax.numpy as jnp

from jaxswarm.swarm.pytree import pytree, static

__all__ = ["PER_DIMENSION", "Crowd", "default_trials", "members_at_first"]

PER_DIMENSION = 18
"""Members of L-SHADE per dimension, as published."""
TRIALS_PER_DIMENSION = 2
"""Its trials in a step: a ninth of that, so that few are left over when few members live."""
SMALLEST = 8
MEANT_FOR = 10_000.0
"""Evaluations a dimension for which the published population is meant."""
EXPONENT = 0.5
"""Of the share of these: between what is best for one valley and for many."""


@pytree
class Crowd:
    """Share of the population with which a run of ``num_steps`` updates begins."""

    num_steps: Any
    of_run: bool = static()

    def __call__(self, n: int, d: int) -> Any:
        """The share for n trials an update in d dimensions."""
        return jnp.clip(self.num_steps * n / (d * MEANT_FOR), 0.0, 1.0) ** EXPONENT


def default_trials(num_dims: int) -> int:
    """Return the trials of a step of L-SHADE: two a dimension, at least eight."""
    return max(SMALLEST, TRIALS_PER_DIMENSION * num_dims)


def members_at_first(crowd: Crowd | None, state: Any) -> jax.Array:
    """Members with which a search begins, int32; the other rows of the population are never born."""
    total, (n, d) = state.member_value.size, state.position.shape
    if crowd is None:
        return jnp.asarray(total, jnp.int32)
    return jnp.clip(jnp.round(total * crowd(n, d)), min(n, total), total).astype(jnp.int32)
