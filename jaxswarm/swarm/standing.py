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
    NOTHING_FEASIBLE,
) = range(9)

MESSAGES = (
    "all steps done",
    "target value reached",
    "best value stalled",
    "no candidate ever had a finite value: check the objective and the bounds",
    "population collapsed to a point",
    "stopped by the given rule",
    "time limit reached",
    "the optimizer has ended by criteria of its own",
    "no feasible candidate was found: the value is 1e30 times one plus the least violation",
)
"""Text of each status code."""


INFEASIBLE = 1e30
"""Above every value of an objective in its units, and with room for 1e8 of violation in a float32."""


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


def outcome(state: Any, code: jax.Array) -> jax.Array:
    """The code of an end, or why a search that came to it has nothing to give; of one run or of many."""
    if _is_constrained(state):
        code = jnp.where(state.best_value >= INFEASIBLE, NOTHING_FEASIBLE, code)
    return jnp.where(state.best_value < jnp.inf, code, NO_FINITE_VALUE)


def _is_constrained(state: Any) -> bool:
    """Whether a state, or one that it wraps, knows how far constraints are broken."""
    return hasattr(state, "violation") or (hasattr(state, "inner") and _is_constrained(state.inner))
