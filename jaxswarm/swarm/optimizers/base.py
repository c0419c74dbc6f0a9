"""What every optimizer is: a pair of pure functions over a population in the unit cube.

    state       = optimizer.init(key, num_dims)
    state, info = optimizer.update(key, state, value)      # value[i] belongs to state.position[i]

The candidates to evaluate are a field of the state, so there is nothing to ask for, and the first
population is evaluated like any other. ``state`` is what the next step needs, ``info`` what an
observer may want; unused parts of ``info`` cost nothing under ``jit``.
"""

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError

__all__ = [
    "Info",
    "Optimizer",
    "State",
    "at_least",
    "best_of",
    "candidate_info",
    "comparable",
    "finished",
    "once",
]


class State(Protocol):
    """Fields that every optimizer state has; algorithms add their own.

    A state class may name in ``CARRIED_FLAT`` those of its (n, d) fields that a loop had better carry
    as (n d,): see :mod:`jaxswarm.swarm.loop`.
    """

    position: jax.Array  # (n, d) candidates to evaluate next, in [0, 1]
    best_position: jax.Array  # (d,) best candidate so far
    best_value: jax.Array  # () its value, +inf before the first finite one
    count: jax.Array  # () int32, number of updates done


class Info(NamedTuple):
    """What one update tells an observer; never carried along.

    Attributes:
      value_best: () best value so far.
      value_mean: () mean of the finite values of this step, NaN if there is none.
      diversity: () root mean square distance of the candidates to their centroid, over sqrt(d).
      improved: () bool, whether the best value fell.
      hyper: the coefficients used in this update, by name.
    """

    value_best: jax.Array
    value_mean: jax.Array
    diversity: jax.Array
    improved: jax.Array
    hyper: dict[str, jax.Array]


class Optimizer(Protocol):
    """Anything with these two functions: a frozen pytree dataclass, or a NamedTuple of closures."""

    def init(self, key: jax.Array, num_dims: int, dtype: Any = None) -> Any:
        """Return the first state; ``dtype`` is that of the positions (default: JAX's float)."""
        ...

    def update(self, key: jax.Array, state: Any, value: jax.Array) -> tuple[Any, Info]:
        """Return the next state, given the values (n,) of ``state.position``; lower is better."""
        ...


def comparable(value: jax.Array, dtype: Any) -> jax.Array:
    """Values as the algorithms compare them: NaN counts as +inf."""
    value = jnp.asarray(value, dtype)
    return jnp.where(jnp.isnan(value), jnp.inf, value)


def best_of(position, value, best_position, best_value):
    """Update the best so far with a population: ``(best_position, best_value, improved)``."""
    leader = jnp.argmin(value)
    improved = value[leader] < best_value
    best_position = jnp.where(improved, position[leader], best_position)
    return best_position, jnp.minimum(value[leader], best_value), improved


def candidate_info(position, value, best_value, improved, hyper) -> Info:
    """Build the :class:`Info` of an update from the candidates just evaluated."""
    finite = jnp.isfinite(value)
    mean = jnp.sum(jnp.where(finite, value, 0.0)) / jnp.sum(finite)
    diversity = jnp.sqrt(jnp.mean((position - position.mean(axis=0)) ** 2))
    return Info(best_value, mean, diversity, improved, hyper)


def finished(state: Any) -> jax.Array | None:
    """() bool, whether a search has ended by criteria of its own; None if it has none.

    A state says so in ``finished``; a wrapper's ``inner`` state is asked in its place, and of several
    populations all have to have ended.
    """
    if hasattr(state, "finished"):
        return jnp.all(state.finished)
    return finished(state.inner) if hasattr(state, "inner") else None


def once(function: Callable[[], Any]) -> Any:
    """Return ``function()``, arrays that a CPU is to compute once although they are read twice.

    XLA would compute them anew for every reader, with all their random numbers, and the
    ``optimization_barrier`` that ought to prevent this is gone before loops are fused on a CPU. A
    branch stays: its condition is always true, which only the barrier hides.
    """

    def branch():
        blank = jax.eval_shape(function)
        never = lambda: jax.tree.map(lambda leaf: jnp.zeros(leaf.shape, leaf.dtype), blank)  # noqa: E731
        return jax.lax.cond(jax.lax.optimization_barrier(True), function, never)

    return jax.lax.platform_dependent(cpu=branch, default=function)


def at_least(name: str, value: int, least: int, why: str) -> int:
    """Check a size when an optimizer is built; sizes are static, so they must be plain integers."""
    if isinstance(value, bool) or not hasattr(value, "__index__"):
        raise InputError(f"{name}={value!r} must be a whole number: it is part of the program.")
    if value < least:
        raise InputError(f"{name}={value} is too small, {why}: use at least {least}.")
    return int(value)
