"""When to stop early: small rules on the progress of a search.

A rule is any function ``(progress) -> (done, code)``: whether to stop and the status that says why.
A rule that looks back has ``start() -> memory`` and is called ``(progress, memory) -> (done, code,
memory)``. Rules are pytrees whose numbers are leaves, so a threshold changes without compiling again.
"""

import time
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.experimental import io_callback

from jaxswarm.errors import InputError
from jaxswarm.swarm.optimizers.base import at_least
from jaxswarm.swarm.pytree import as_part, pytree
from jaxswarm.swarm.schedules import coefficient
from jaxswarm.swarm.standing import (
    COLLAPSED,
    SEARCH_ENDED,
    STALLED,
    STEPS_DONE,
    TARGET_REACHED,
    TIME_UP,
    Progress,
)

__all__ = [
    "any_of",
    "collapsed",
    "renewed",
    "search_ended",
    "stalled",
    "target",
    "time_limit",
]


def target(value: float) -> "Target":
    """Stop as soon as the best value is at most ``value``."""
    return Target(coefficient("value", value))


def stalled(patience: int, *, tolerance: float = 0.0, relative: float = 0.0) -> Any:
    """Stop when the best value has not fallen for ``patience`` updates.

    Args:
      patience: updates, at least 1.
      tolerance: smallest fall that counts, in the objective's unit; falls add up until they do.
      relative: the same as a share of the size of the value; the larger of both holds.
    """
    if isinstance(patience, int):
        at_least("patience", patience, 1, "a rule must give a step time to act")
    patience = coefficient("patience", patience)
    falls = [coefficient("tolerance", tolerance, lower=0.0)]
    falls.append(coefficient("relative", relative, lower=0.0))
    none = all(isinstance(fall, float) and fall == 0.0 for fall in falls)
    return Stalled(patience) if none else StalledBy(patience, *falls)


def collapsed(diversity: float) -> "Collapsed":
    """Stop when the candidates lie closer together than ``diversity`` (unit cube, RMS)."""
    return Collapsed(coefficient("diversity", diversity, lower=0.0))


def search_ended() -> "SearchEnded":
    """Stop when the optimizer has ended by criteria of its own, as ``cma_es`` does.

    Without this rule such a search goes on being stepped, which finds hardly more.
    """
    return SearchEnded()


def time_limit(seconds: float) -> "TimeLimit":
    """Stop at the first update that ends later than ``seconds`` after the first one ended.

    Time that the compiler needs does not count; that a clock decides makes the search different
    from call to call. A step asks the host for the time, which takes about 0.1 ms.
    """
    return TimeLimit(coefficient("seconds", seconds, lower=0.0))


def any_of(*rules: Any) -> "AnyOf | AnyOfBack":
    """Stop when one of the rules says so; the first that does gives the status."""
    if not rules:
        raise InputError("any_of() has no rules: give at least one, any_of(target(1e-6)).")
    for rule in rules:
        if not callable(rule):
            raise InputError(
                f"any_of was given {rule!r}: give rules one by one, any_of(target(1e-6))."
            )
    parts = tuple(as_part(rule) for rule in rules)
    back = any(hasattr(rule, "start") for rule in rules)
    return AnyOfBack(parts) if back else AnyOf(parts)


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
        return jnp.asarray(progress.since, float) >= jnp.asarray(self.patience, float), STALLED


@pytree
class StalledBy:
    """See :func:`stalled`; remembers the value that counted last, and when."""

    patience: float
    tolerance: float
    relative: float

    def start(self):
        """Nothing seen yet."""
        return jnp.asarray(jnp.inf, float), jnp.zeros((), jnp.int32)

    def __call__(self, progress: Progress, memory):
        value, when = memory
        now = jnp.asarray(progress.value, value.dtype)
        fall = jnp.maximum(self.tolerance, self.relative * jnp.abs(value))
        counts = jnp.where(jnp.isfinite(value), now < value - fall, now < value)
        value, when = jnp.where(counts, now, value), jnp.where(counts, progress.count, when)
        waited = jnp.asarray(progress.count - when, float)
        return waited >= jnp.asarray(self.patience, float), STALLED, (value, when)


@pytree
class Collapsed:
    """See :func:`collapsed`."""

    diversity: float

    def __call__(self, progress: Progress):
        return progress.diversity <= self.diversity, COLLAPSED


@pytree
class SearchEnded:
    """See :func:`search_ended`."""

    def __call__(self, progress: Progress):
        return progress.finished, SEARCH_ENDED


BEGUN = time.monotonic()
"""Where this process counts seconds from: a float32 must tell milliseconds apart."""
NOT_RUNNING = -1.0
"""What a clock remembers before the first update has ended. No NaN, which ``jax_debug_nans`` stops at."""


@pytree
class TimeLimit:
    """See :func:`time_limit`; remembers when the first update ended."""

    seconds: float

    def start(self):
        """The clock is not running yet."""
        return jnp.asarray(NOT_RUNNING, jnp.float32)

    def __call__(self, progress: Progress, memory):
        # The count as an argument keeps the compiler from asking once for all steps.
        now = io_callback(_clock, jax.ShapeDtypeStruct((), jnp.float32), progress.count)
        first = jnp.where(memory == NOT_RUNNING, now, memory)
        return now - first >= self.seconds, TIME_UP, first


def _clock(count):
    return np.asarray(np.full(np.shape(count), time.monotonic() - BEGUN), np.float32)


@pytree
class AnyOf:
    """See :func:`any_of`."""

    rules: tuple

    def __call__(self, progress: Progress):
        return AnyOfBack(self.rules)(progress, ((),) * len(self.rules))[:2]


@pytree
class AnyOfBack:
    """See :func:`any_of`; with rules that look back."""

    rules: tuple

    def start(self):
        """Memories of all rules."""
        return tuple(begin(rule) for rule in self.rules)

    def __call__(self, progress: Progress, memory):
        done, code, kept = jnp.asarray(False), jnp.asarray(STEPS_DONE, jnp.int32), []
        for rule, own in zip(self.rules, memory, strict=True):
            here, reason, own = ask(rule, progress, own)
            code = jnp.where(here & ~done, reason, code)
            done = done | here
            kept.append(own)
        return done, code, tuple(kept)


def begin(rule: Any) -> Any:
    """Memory with which a rule starts; () for one that does not look back, and for no rule."""
    return rule.start() if hasattr(rule, "start") else ()


def ask(rule: Any, progress: Progress, memory: Any) -> tuple:
    """Whether to stop, the status code, and the rule's new memory."""
    if hasattr(rule, "start"):
        return rule(progress, memory)
    said = rule(progress)
    if not (isinstance(said, tuple) and len(said) == 2):
        raise InputError(
            f"a stop rule returned {said!r}: return (done, code), code 5 for one of yours."
        )
    return *said, memory


def renewed(rule: Any, memory: Any) -> Any:
    """The memory with which a rule goes on in another process: clocks start anew there."""
    if isinstance(rule, TimeLimit):
        return jax.tree.map(lambda leaf: jnp.full_like(leaf, NOT_RUNNING), memory)
    if isinstance(rule, AnyOfBack):
        return tuple(renewed(*pair) for pair in zip(rule.rules, memory, strict=True))
    return memory
