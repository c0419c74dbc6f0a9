"""What every optimizer is: a pair of pure functions over a population in the unit cube.

    state       = optimizer.init(key, num_dims)
    state, info = optimizer.update(key, state, value)      # value[i] belongs to state.position[i]

The candidates to evaluate are a field of the state, so there is nothing to ask for, and the first
population is evaluated like any other. ``state`` is what the next step needs, ``info`` what an
observer may want; unused parts of ``info`` cost nothing under ``jit``.
"""

import inspect
from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError
from jaxswarm.swarm.pytree import as_part
from jaxswarm.swarm.space import Space

__all__ = [
    "Info",
    "Optimizer",
    "State",
    "as_optimizer",
    "at_least",
    "best_of",
    "candidate_info",
    "comparable",
    "dimensions",
    "finished",
    "num_values",
    "once",
]


class State(Protocol):
    """Fields that every optimizer state has; algorithms add their own.

    A state class may name in ``CARRIED_LANED`` those of its (n, d) fields that a loop had better carry
    as :mod:`jaxswarm.swarm.lanes` lays them. One that keeps candidates with their values from step to step
    names the fields of both in ``MEMORY``, so that others can read them and value them anew.
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
    """Anything with these two functions.

    A frozen pytree dataclass, whose numbers can change without compiling; a NamedTuple of closures; an
    object with methods. ``num_dims`` is a size, thus part of the program, and JAX's transformations
    trace every argument: hand them a ``Space`` in its place, which knows its size while it is traced,
    as in ``jax.eval_shape(optimizer.init, key, space)``, or close over the number.
    """

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> Any:
        """Return the first state.

        Args:
          key: JAX key.
          num_dims: d, a whole number or a ``Space`` of that size.
          dtype: of the positions; default JAX's float.
        """
        ...

    def update(self, key: jax.Array, state: Any, value: jax.Array) -> tuple[Any, Info]:
        """Return the next state, given the values (n,) of ``state.position``; lower is better."""
        ...


def dimensions(num_dims: Any) -> int:
    """Return the number of coordinates d that was asked for, as a number or by a ``Space``.

    Raises:
      InputError: a traced number, which cannot be a size; no whole number; none at all.
    """
    if isinstance(num_dims, Space):
        return num_dims.size
    if isinstance(num_dims, jax.core.Tracer):
        raise InputError(
            "num_dims is traced, but sizes are part of the program: give a Space in its place, as in "
            "jax.eval_shape(optimizer.init, key, space), or close over the number, as in "
            "jax.eval_shape(functools.partial(optimizer.init, num_dims=3), key)."
        )
    return at_least("num_dims", num_dims, 1, "a search has coordinates")


def comparable(value: jax.Array, like: Any) -> jax.Array:
    """Values as the algorithms compare them: NaN counts as +inf.

    Args:
      value: (n,).
      like: the candidates (n, d) to which the values belong, or only the dtype of these.

    Raises:
      InputError: another number of values than of candidates.
    """
    candidates = isinstance(like, jax.Array)
    if candidates:
        _check_number(like, value)
    value = jnp.asarray(value, like.dtype if candidates else like)
    return jnp.where(jnp.isnan(value), jnp.inf, value)


def _check_number(position, value):
    if jnp.shape(value) != position.shape[:1]:
        raise InputError(
            f"value has shape {jnp.shape(value)}, the state has {position.shape[0]} candidates: give "
            "update one value for each row of state.position."
        )


class Functions(NamedTuple):
    """An optimizer as a pair of functions."""

    init: Any
    update: Any


def as_optimizer(thing: Any) -> Any:
    """Return an optimizer that JAX can pass around, or say what is in its place.

    Functions among its leaves become static parts; an object that is no pytree is taken for its two
    methods.

    Raises:
      InputError: a factory that was not called, a list of optimizers, anything else.
    """
    if isinstance(thing, list | tuple) and not hasattr(thing, "init"):
        raise InputError(
            f"optimizer is a {type(thing).__name__} of {len(thing)}: give a single optimizer; "
            "islands(optimizer, num) runs several populations of one kind."
        )
    if isinstance(thing, type) or (callable(thing) and not hasattr(thing, "init")):
        name = getattr(thing, "__name__", repr(thing))
        raise InputError(f"optimizer={name} is a factory, not an optimizer: call it, {name}().")
    if not (callable(getattr(thing, "init", None)) and callable(getattr(thing, "update", None))):
        raise InputError(
            f"optimizer={thing!r} has no init and update: use a factory such as pso(), or an object "
            "with these two functions (check_optimizer tells the rest)."
        )
    _check_init(thing.init)
    if jax.tree_util.all_leaves([thing]):
        return Functions(jax.tree_util.Partial(thing.init), jax.tree_util.Partial(thing.update))
    return jax.tree.map(as_part, thing)


def _check_init(init):
    try:
        signature = inspect.signature(init)
    except (TypeError, ValueError):
        return  # compiled ones need not tell
    try:
        signature.bind("key", "num_dims", dtype=None)
    except TypeError:
        raise InputError(
            f"optimizer: init takes {signature}, it is called as init(key, num_dims, dtype=None). What follows "
            "gradients, as in optax, polishes what a search found: polish(fn, space, result)."
        ) from None


def num_values(optimizer: Any) -> int | None:
    """Numbers that an objective returns for a candidate; None for a single value.

    An optimizer that wants several says so in ``num_values``; a wrapper wants what its ``inner`` does.
    """
    if hasattr(optimizer, "num_values"):
        return optimizer.num_values
    return num_values(optimizer.inner) if hasattr(optimizer, "inner") else None


def best_of(position, value, best_position, best_value):
    """Update the best so far with a population: ``(best_position, best_value, improved)``."""
    _check_number(position, value)
    leader = jnp.argmin(value)
    improved = value[leader] < best_value
    best_position = jnp.where(improved, position[leader], best_position)
    return best_position, jnp.minimum(value[leader], best_value), improved


def candidate_info(position, value, best_value, improved, hyper) -> Info:
    """Build the :class:`Info` of an update from the candidates just evaluated."""
    finite = jnp.isfinite(value)
    mean = jnp.sum(jnp.where(finite, value, 0.0)) / jnp.sum(finite, dtype=value.dtype)
    diversity = jnp.sqrt(jnp.mean((position - position.mean(axis=0, keepdims=True)) ** 2))
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
