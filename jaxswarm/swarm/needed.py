"""What memory a search holds for what it was asked for, refused where there is less."""

from typing import Any

import jax

from jaxswarm.memory import GIB, refuse_beyond_free

__all__ = ["refuse_too_many", "state_bytes"]

UNASKED = 2**28
"""Bytes that every machine has: to ask for less costs more than it tells."""
COPIES = 2
"""The state that a step reads and the one that it makes; the history as steps write it and by runs."""
NUMBER = 8
"""Bytes of a number of the history, or of a coordinate."""


def state_bytes(optimizer: Any, num_dims: int, dtype: Any) -> int:
    """Bytes of the state of one run."""
    key = jax.eval_shape(lambda: jax.random.key(0))
    state = jax.eval_shape(lambda k: optimizer.init(k, num_dims, dtype=dtype), key)
    return sum(leaf.size * leaf.dtype.itemsize for leaf in jax.tree.leaves(state))


def refuse_too_many(optimizer: Any, space: Any, num_steps: int, runs: int = 1) -> None:
    """Refuse a search whose states and history alone would not fit into memory.

    Args:
      num_steps: each keeps a number a run; 0: none is kept beforehand.
      runs: searches side by side.

    Raises:
      InputError: with the memory that is needed, and what there is.
    """
    particles = getattr(optimizer, "num_particles", None) or 1
    if NUMBER * runs * (num_steps + particles * space.size) < UNASKED:
        return
    history = COPIES * NUMBER * runs * num_steps
    states = COPIES * runs * state_bytes(optimizer, space.size, space.dtype)
    steps = f", {runs} times {num_steps} steps," if num_steps else ""
    what = f"a search in {space.size} dimensions{steps} takes"
    refuse_beyond_free((history + states) / GIB, what, "ask for fewer runs, particles or steps")
