"""How a search stands and how it ends: what stop rules see, and the codes by which the end is told."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.swarm.optimizers.base import finished

(
    STEPS_DONE,
    TARGET_REACHED,
    STALLED,
    NO_FINITE_VALUE,
    COLLAPSED,
    CUSTOM,
    TIME_UP,
    SEARCH_ENDED,
) = range(8)

MESSAGES = (
    "all steps done",
    "target value reached",
    "best value stalled",
    "no candidate ever had a finite value: check the objective and the bounds",
    "population collapsed to a point",
    "stopped by the given rule",
    "time limit reached",
    "the optimizer has ended by criteria of its own",
)
"""Text of each status code."""


class Progress(NamedTuple):
    """What a stop rule sees after an update; all scalars.

    Attributes:
      count: updates done.
      value: best value so far.
      since: updates since the best value last fell.
      diversity: spread of the candidates just evaluated, see ``Info``.
      finished: whether the optimizer has ended by criteria of its own; never of one that has none.
    """

    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple
    value: jax.Array
    since: jax.Array
    diversity: jax.Array
    finished: jax.Array | bool = False


def progress_of(state: Any, since: jax.Array, diversity: jax.Array) -> Progress:
    """What a rule sees of a search whose optimizer has this state."""
    own = finished(state)
    own = jnp.asarray(False) if own is None else own
    return Progress(state.count, state.best_value, since, diversity, own)
