"""A schedule can stand wherever a number can: any ``count -> scalar``, every optax schedule.

Update number k uses ``schedule(k)``, k = 0, 1, 2, ... An optax schedule is a closure: its own
numbers are compiled in, and a new one compiles anew. The schedules of this module are frozen
dataclasses whose numbers are leaves, so they can be changed, mapped over and differentiated for
nothing, and told apart by what they hold.

A schedule without ``num_steps`` lasts as long as the run: ``minimize`` gives it its own number of
steps (:func:`for_run`). One that has a number keeps it.
"""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.tree_util import Partial

from jaxswarm.errors import InputError
from jaxswarm.swarm.pytree import pytree, replace, static

ScalarOrSchedule = float | jax.Array | Callable[[jax.Array], Any]

__all__ = [
    "ScalarOrSchedule",
    "coefficient",
    "cosine",
    "evaluate",
    "exponential",
    "for_run",
    "linear",
    "run_length",
]

BY_HAND = 1000.0
"""Updates that a schedule without a length assumes where no ``minimize`` tells it one."""


@pytree
class Linear:
    """See :func:`linear`."""

    start: Any
    end: Any
    num_steps: Any
    of_run: bool = static(default=False)

    def __call__(self, count):
        return self.start + (self.end - self.start) * _fraction(count, self.num_steps)


@pytree
class Cosine:
    """See :func:`cosine`."""

    start: Any
    end: Any
    num_steps: Any
    of_run: bool = static(default=False)

    def __call__(self, count):
        wave = 0.5 * (1.0 + jnp.cos(jnp.pi * _fraction(count, self.num_steps)))
        return self.end + (self.start - self.end) * wave


@pytree
class Exponential:
    """See :func:`exponential`."""

    start: Any
    end: Any
    num_steps: Any
    of_run: bool = static(default=False)

    def __call__(self, count):
        return self.start * (self.end / self.start) ** _fraction(count, self.num_steps)


def linear(
    start: float, end: float, num_steps: float | None = None, *, by_hand: float = BY_HAND
) -> Linear:
    """Straight line from ``start`` at count 0 to ``end`` at count ``num_steps``, constant after.

    Args:
      start: value at count 0.
      end: value from count ``num_steps`` on.
      num_steps: updates in between; None for as many as ``minimize`` makes.
      by_hand: updates in between where it is None and nobody says how long the run is.

    >>> float(evaluate("inertia", linear(0.9, 0.4, 100), 50))
    0.65
    >>> float(evaluate("inertia", for_run(linear(0.9, 0.4), 10), 10))
    0.4
    """
    steps, of_run = run_length(num_steps, by_hand)
    return Linear(*_ends(start, end), steps, of_run)


def cosine(
    start: float, end: float, num_steps: float | None = None, *, by_hand: float = BY_HAND
) -> Cosine:
    """Half a cosine wave from ``start`` to ``end``; arguments as of :func:`linear`.

    >>> round(float(evaluate("inertia", cosine(1.0, 0.0, 100), 25)), 4)
    0.8536
    """
    steps, of_run = run_length(num_steps, by_hand)
    return Cosine(*_ends(start, end), steps, of_run)


def exponential(
    start: float, end: float, num_steps: float | None = None, *, by_hand: float = BY_HAND
) -> Exponential:
    """Geometric decay from ``start`` to ``end`` (both > 0); arguments as of :func:`linear`.

    >>> round(float(evaluate("scale", exponential(1.0, 0.01, 100), 50)), 6)
    0.1
    """
    steps, of_run = run_length(num_steps, by_hand)
    return Exponential(*_ends(start, end), steps, of_run)


def run_length(num_steps: float | None, by_hand: float) -> tuple[Any, bool]:
    """``num_steps`` as a leaf, and whether it is to be replaced by that of the run."""
    given = by_hand if num_steps is None else num_steps
    return coefficient("num_steps", given, lower=1.0), num_steps is None


def for_run(tree: Any, num_steps: Any) -> Any:
    """Give every part of an optimizer that lasts as long as the run the run's number of steps.

    Args:
      tree: optimizer, wrapped ones included, or any pytree. A part waits for the length if it is a
        dataclass with ``num_steps`` and a true ``of_run``.
      num_steps: updates of the run; a float is a leaf like any other.

    Returns:
      The same with the lengths set; what has a length of its own keeps it.

    >>> for_run(linear(0.9, 0.4), 500.0) == linear(0.9, 0.4, 500), for_run(linear(1, 0, 9), 500.0)
    (True, Linear(start=1.0, end=0.0, num_steps=9.0, of_run=False))
    """

    def waits(part):
        return getattr(part, "of_run", False) is True

    def bind(part):
        return replace(part, num_steps=num_steps, of_run=False) if waits(part) else part

    return jax.tree.map(bind, tree, is_leaf=waits)


def coefficient(
    name: str, value: ScalarOrSchedule, *, lower: float = -np.inf, upper: float = np.inf
) -> Any:
    """Check a coefficient when an optimizer is built and bring it into the form of a leaf.

    Args:
      name: what to call it in a message.
      value: number, scalar array, or schedule.
      lower: smallest value allowed for a number known now.
      upper: largest value allowed for a number known now.

    Returns:
      A Python float, the array, or the schedule as a pytree.

    Raises:
      InputError: a vector, a schedule that returns one, something else, or a number out of range.
    """
    if callable(value):
        schedule = value if isinstance(value, Partial) else as_schedule(value)
        try:
            out = jax.eval_shape(schedule, jax.ShapeDtypeStruct((), jnp.int32))
        except Exception as error:
            raise InputError(
                f"{name}: the schedule cannot be called with a step count ({error})."
            ) from error
        _require_scalar(name, out)
        return schedule
    if isinstance(value, jax.Array):
        _require_scalar(name, value)
        return value
    try:
        if isinstance(value, str):
            raise TypeError("text")  # which NumPy would read
        number = np.asarray(value, float)
    except (TypeError, ValueError) as error:
        raise InputError(
            f"{name}={value!r} is neither a number nor a schedule (count -> number)."
        ) from error
    _require_scalar(name, number)
    if not lower <= float(number) <= upper:
        raise InputError(f"{name}={value!r} must lie in [{lower:g}, {upper:g}].")
    return float(number)


def as_schedule(function: Callable[[jax.Array], Any]) -> Any:
    """Make a plain function ``count -> scalar`` a pytree; a callable pytree stays as it is."""
    return Partial(function) if jax.tree_util.all_leaves([function]) else function


def evaluate(
    name: str, value: ScalarOrSchedule, count: int | jax.Array, dtype: Any = float
) -> jax.Array:
    """Return the coefficient of update number ``count``: a scalar array of ``dtype``."""
    out = value(jnp.asarray(count, jnp.int32)) if callable(value) else value
    _require_scalar(name, out)
    return jnp.asarray(out, dtype)


def _require_scalar(name: str, value: Any) -> None:
    shape = jnp.shape(value) if not hasattr(value, "shape") else value.shape
    if shape != ():
        raise InputError(
            f"{name} has shape {shape}, one number is needed. To sweep over several, build with "
            f"one and map: jax.vmap over dataclasses.replace(optimizer, {name}=values)."
        )


def _ends(start: Any, end: Any) -> tuple[Any, Any]:
    """Numbers of a schedule as leaves: one that is once an int and once a float compiles twice."""
    return coefficient("start", start), coefficient("end", end)


def _fraction(count, num_steps):
    return jnp.clip(jnp.asarray(count, jnp.result_type(float)) / num_steps, 0.0, 1.0)
