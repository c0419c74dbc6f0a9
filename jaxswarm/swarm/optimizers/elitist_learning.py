"""Elitist learning: the best candidate tries a jump in one coordinate, every step.

    trial = best;   trial_j <- clip(best_j + N(0, scale^2)),   j random

The trial rides along as one candidate more (one evaluation a step, counted like any other). If it
beats everything seen it takes the place of the worst candidate of its step before the wrapped
optimizer sees the values, which is the one way in that every optimizer has. With ``extra=False`` it
takes that place beforehand and costs no evaluation.

Reference:
    Z.-H. Zhan et al., "Adaptive particle swarm optimization", IEEE Trans. Syst. Man Cybern. B 39
    (2009), doi 10.1109/TSMCB.2009.2015956, section IV-C (there the trial replaces the leader's
    memory).
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError, nearest
from jaxswarm.swarm.optimizers.base import as_optimizer, comparable
from jaxswarm.swarm.optimizers.beginning import begin
from jaxswarm.swarm.pytree import as_part, pytree, replace, static
from jaxswarm.swarm.random import Random, check_source, fold
from jaxswarm.swarm.schedules import ScalarOrSchedule, coefficient, evaluate

__all__ = ["ElitistLearning", "ElitistLearningState", "elitist_learning"]

FAILURES = ("discard", "replace worst")


class ElitistLearningState(NamedTuple):
    """State of the wrapped optimizer, and the candidates with the trial among them."""

    inner: Any
    position: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


@pytree
class ElitistLearning:
    """See :func:`elitist_learning`."""

    inner: Any
    scale: ScalarOrSchedule
    gate: Any
    on_failure: str = static()
    extra: bool = static()
    random: str = static()

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> ElitistLearningState:
        """The first candidates of the wrapped optimizer, and a first trial."""
        inner = self.inner.init(fold(key, 1), num_dims, dtype=dtype)
        worst = inner.position.shape[0] - 1
        return self._state(Random(key, self.random), inner, worst, jnp.zeros((), jnp.int32))[0]

    def begin(self, key: jax.Array, state: ElitistLearningState, points: jax.Array, spread: Any):
        """The wrapped optimizer begins at the points, the first jump at the first of them."""
        inner = begin(self.inner, key, state.inner, points, spread)
        worst = inner.position.shape[0] - 1
        return self._state(Random(key, self.random), inner, worst, state.count)[0]

    def update(self, key: jax.Array, state: ElitistLearningState, value: jax.Array):
        """Let the trial in if it deserves it, update what is wrapped, try the next jump."""
        value = comparable(value, state.position)
        position = state.position
        if self.extra:
            position, trial = position[:-1], position[-1]
            value, trial_value = value[:-1], value[-1]
            worst = jnp.argmax(value)
            enters = trial_value < jnp.minimum(state.best_value, value.min())
            if self.on_failure == "replace worst":
                enters = jnp.asarray(True)
            replaced = enters & (jnp.arange(value.shape[0]) == worst)
            position = jnp.where(replaced[:, None], trial[None], position)
            value = jnp.where(replaced, trial_value, value)
        inner = replace(state.inner, position=position)
        inner, info = self.inner.update(fold(key, 1), inner, value)
        random = Random(key, self.random)
        state, scale = self._state(random, inner, jnp.argmax(value), state.count + 1)
        return state, info._replace(hyper=info.hyper | {"learning_scale": scale})

    def _state(self, random, inner, worst, count):
        best, dtype = inner.best_position, inner.position.dtype
        scale = evaluate("scale", self.scale, count, dtype)
        jump = scale * random.normal("jump", (), dtype)
        coordinate = random.integers("coordinate", (), best.shape[0])
        chosen = jnp.arange(best.shape[0], dtype=jnp.int32) == coordinate
        trial = jnp.clip(jnp.where(chosen, best + jump, best), 0.0, 1.0)
        is_open = jnp.asarray(True) if self.gate is None else self.gate(inner)
        if self.extra:
            # A closed gate cannot change the number of candidates: the best is looked at again.
            trial = jnp.where(is_open, trial, best)
            position = jnp.concatenate([inner.position, trial[None]])
        else:
            row = jnp.where(is_open, trial, inner.position[worst])
            position = inner.position.at[worst].set(row)
        state = ElitistLearningState(inner, position, best, inner.best_value, count)
        return state, scale


def elitist_learning(
    inner: Any,
    scale: ScalarOrSchedule = 0.1,
    *,
    gate: Any = None,
    on_failure: str = "discard",
    extra: bool = True,
    random: str = "hash",
) -> ElitistLearning:
    """Wrap an optimizer so that its best candidate tries jumps in single coordinates.

    Args:
      inner: any optimizer, wrapped ones included.
      scale: standard deviation of a jump in units of the cube; number k of the jumps uses
        ``scale(k)``, k = 0 for the one evaluated first.
      gate: ``state -> bool``, when to try, e.g. ``converged()``; default always.
      on_failure: with ``extra``, what becomes of a trial that is not better: ``"discard"``, or
        ``"replace worst"`` to put it in the worst candidate's place all the same.
      extra: whether the trial comes on top of the candidates or in place of the worst.
      random: ``"hash"`` or ``"threefry"``.

    >>> from jaxswarm.swarm import pso
    >>> elitist_learning(pso(10)).init(jax.random.key(0), 3).position.shape
    (11, 3)
    """
    if on_failure not in FAILURES:
        raise InputError(f"on_failure={on_failure!r}. {nearest(str(on_failure), FAILURES)}")
    return ElitistLearning(
        inner=as_optimizer(inner),
        scale=coefficient("scale", scale, lower=0.0),
        gate=None if gate is None else as_part(gate),
        on_failure=on_failure,
        extra=bool(extra),
        random=check_source(random),
    )
