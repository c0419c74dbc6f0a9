"""A schedule can stand wherever a number can: any ``count -> scalar``, every optax schedule.

Update number k uses ``schedule(k)``, k = 0, 1, 2, ... An optax schedule is a closure: its own
numbers are compiled in, and a new one compiles anew. The schedules of this module keep their
numbers as leaves (``jax.tree_util.Partial``), so they can be changed, mapped over and
differentiated for nothing.
"""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.tree_util import Partial

from jaxswarm.errors import InputError

ScalarOrSchedule = float | jax.Array | Callable[[jax.Array], Any]

__all__ = ["ScalarOrSchedule", "coefficient", "cosine", "evaluate", "exponential", "linear"]


def linear(start: float, end: float, num_steps: float) -> Partial:
    """Straight line from ``start`` at count 0 to ``end`` at count ``num_steps``, constant after.

    >>> float(evaluate("inertia", linear(0.9, 0.4, 100), 50))
    0.65
    """
    return Partial(_linear, *_numbers(start, end, num_steps))


def cosine(start: float, end: float, num_steps: float) -> Partial:
    """Half a cosine wave from ``start`` to ``end`` over ``num_steps`` updates, constant after.

    >>> round(float(evaluate("inertia", cosine(1.0, 0.0, 100), 25)), 4)
    0.8536
    """
    return Partial(_cosine, *_numbers(start, end, num_steps))


def exponential(start: float, end: float, num_steps: float) -> Partial:
    """Geometric decay from ``start`` to ``end`` (both > 0) over ``num_steps``, constant after.

    >>> round(float(evaluate("scale", exponential(1.0, 0.01, 100), 50)), 6)
    0.1
    """
    return Partial(_exponential, *_numbers(start, end, num_steps))


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


def _numbers(start, end, num_steps):
    """Numbers of a schedule as leaves: one that is once an int and once a float compiles twice."""
    length = coefficient("num_steps", num_steps, lower=1.0)
    return coefficient("start", start), coefficient("end", end), length


def _fraction(count, num_steps, dtype):
    return jnp.clip(jnp.asarray(count, dtype) / num_steps, 0.0, 1.0)


def _linear(start, end, num_steps, count):
    fraction = _fraction(count, num_steps, jnp.result_type(float))
    return start + (end - start) * fraction


def _cosine(start, end, num_steps, count):
    fraction = _fraction(count, num_steps, jnp.result_type(float))
    return end + (start - end) * 0.5 * (1.0 + jnp.cos(jnp.pi * fraction))


def _exponential(start, end, num_steps, count):
    fraction = _fraction(count, num_steps, jnp.result_type(float))
    return start * (end / start) ** fraction
