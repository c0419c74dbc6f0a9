"""When to stop early: small pure rules on the state of a search.

A rule is any function ``(progress) -> (done, code)``: whether to stop and the status that says why.
Rules are pytrees whose numbers are leaves, so a threshold changes without compiling again.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError
from jaxswarm.swarm.optimizers.base import at_least
from jaxswarm.swarm.pytree import as_part, pytree
from jaxswarm.swarm.schedules import coefficient

__all__ = ["MESSAGES", "Progress", "any_of", "collapsed", "stalled", "target"]

STEPS_DONE, TARGET_REACHED, STALLED, NO_FINITE_VALUE, COLLAPSED, CUSTOM = range(6)

MESSAGES = (
    "all steps done",
    "target value reached",
    "best value stalled",
    "no candidate ever had a finite value: check the objective and the bounds",
    "population collapsed to a point",
    "stopped by the given rule",
)
"""Text of each status code."""


class Progress(NamedTuple):
    """What a stop rule sees after an update; all scalars.

    Attributes:
      count: updates done.
      value: best value so far.
      since: updates since the best value last fell.
      diversity: spread of the candidates just evaluated, see ``Info``.
    """

    count: jax.Array
    value: jax.Array
    since: jax.Array
    diversity: jax.Array


def target(value: float) -> "Target":
    """Stop as soon as the best value is at most ``value``."""
    return Target(coefficient("value", value))


def stalled(patience: int) -> "Stalled":
    """Stop when the best value has not fallen for ``patience`` updates."""
    if isinstance(patience, int):
        at_least("patience", patience, 1, "a rule must give a step time to act")
    return Stalled(coefficient("patience", patience))


def collapsed(diversity: float) -> "Collapsed":
    """Stop when the candidates lie closer together than ``diversity`` (unit cube, RMS)."""
    return Collapsed(coefficient("diversity", diversity, lower=0.0))


def any_of(*rules: Any) -> "AnyOf":
    """Stop when one of the rules says so; the first that does gives the status."""
    if not rules:
        raise InputError("any_of() has no rules: give at least one, any_of(target(1e-6)).")
    return AnyOf(tuple(as_part(rule) for rule in rules))


@pytree
class Target:
    """See :func:`target`."""

    value: float

    def __call__(self, progress: Progress):
        return progress.value <= self.value, TARGET_REACHED


@pytree
class Stalled:
    """See :func:`stalled`."""

    patience: float

    def __call__(self, progress: Progress):
        return progress.since >= self.patience, STALLED


@pytree
class Collapsed:
    """See :func:`collapsed`."""

    diversity: float

    def __call__(self, progress: Progress):
        return progress.diversity <= self.diversity, COLLAPSED


@pytree
class AnyOf:
    """See :func:`any_of`."""

    rules: tuple

    def __call__(self, progress: Progress):
        done, code = jnp.asarray(False), jnp.asarray(STEPS_DONE, jnp.int32)
        for rule in self.rules:
            here, reason = rule(progress)
            code = jnp.where(here & ~done, reason, code)
            done = done | here
        return done, code
