"""Restart: begin anew when the search has ended, and keep what was found.

An optimizer that knows when it has ended (``state.finished``, as ``cma_es`` does) is left alone until
then; any other is taken for ended when it has stalled or collapsed. One that begins anew by itself, as
``pso`` and ``de`` do, no longer does so in here.

Reference:
    A. Auger, N. Hansen, "A restart CMA evolution strategy with increasing population size", CEC
    2005 (the idea; here the population keeps its size, in ``ipop_cma_es`` it grows).
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.swarm.optimizers.base import as_optimizer, finished
from jaxswarm.swarm.optimizers.beginning import begin
from jaxswarm.swarm.optimizers.rest import NEAR, PATIENCE
from jaxswarm.swarm.pytree import pytree, replace, static
from jaxswarm.swarm.random import fold
from jaxswarm.swarm.schedules import coefficient

__all__ = ["Restart", "RestartState", "restart"]


class RestartState(NamedTuple):
    """State of the wrapped optimizer and the record over all its lives.

    Attributes:
      since: () int32, updates since the present life last improved.
      restarts: () int32, lives ended so far.
    """

    inner: Any
    position: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    since: jax.Array
    restarts: jax.Array
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


@pytree
class Restart:
    """See :func:`restart`."""

    inner: Any
    patience: Any
    diversity: Any
    keep: bool = static()

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> RestartState:
        """The first life."""
        inner = self.inner.init(fold(key, 1), num_dims, dtype=dtype)
        zero = jnp.zeros((), jnp.int32)
        best = inner.best_position, inner.best_value
        return RestartState(inner, inner.position, *best, zero, zero, zero)

    def begin(self, key: jax.Array, state: RestartState, points: jax.Array, spread: Any):
        """The first life begins at the points; the others do not."""
        inner = begin(self.inner, key, state.inner, points, spread)
        return state._replace(
            inner=inner, position=inner.position, best_position=inner.best_position
        )

    def update(self, key: jax.Array, state: RestartState, value: jax.Array):
        """Update the present life, or end it."""
        inner = replace(state.inner, position=state.position)
        inner, info = self.inner.update(fold(key, 1), inner, value)
        improved = inner.best_value < state.best_value
        best_value = jnp.minimum(inner.best_value, state.best_value)
        best_position = jnp.where(improved, inner.best_position, state.best_position)
        since = jnp.where(info.improved, 0, state.since + 1)
        ended = self._ended(inner, since, info.diversity)

        def anew():
            fresh = self.inner.init(fold(key, 2), state.position.shape[1], state.position.dtype)
            position = fresh.position
            return (
                replace(fresh, position=position.at[0].set(best_position)) if self.keep else fresh
            )

        inner = jax.lax.cond(ended, anew, lambda: inner)
        state = RestartState(
            inner=inner,
            position=inner.position,
            best_position=best_position,
            best_value=best_value,
            since=jnp.where(ended, 0, since),
            restarts=state.restarts + ended.astype(jnp.int32),
            count=state.count + 1,
        )
        return state, info._replace(value_best=best_value, improved=improved)

    def _ended(self, inner, since, diversity):
        own = finished(inner)
        patience, limit = self.patience, self.diversity
        if own is None:
            patience = PATIENCE if patience is None else patience
            limit = NEAR if limit is None else limit
        ended = jnp.asarray(False) if own is None else own
        if patience is not None:
            ended = ended | (since.astype(float) >= jnp.asarray(patience, float))
        return ended if limit is None else ended | (diversity < limit)


def restart(
    inner: Any,
    *,
    patience: float | None = None,
    diversity: float | None = None,
    keep: bool = False,
) -> Restart:
    """Wrap an optimizer so that it starts anew when it has ended, stalled or collapsed.

    The schedules of the wrapped optimizer begin again with every life; one without a length of its
    own lasts as long as the whole run, which most lives do not reach.

    Args:
      inner: any optimizer, wrapped ones included.
      patience: updates without improvement after which a life ends; default 50, and no limit for an
        optimizer that knows when it has ended.
      diversity: spread of the candidates (RMS, unit cube) below which a life ends; default 1e-6, and
        no limit for such an optimizer.
      keep: whether the best candidate so far is the first of the new population.

    >>> from jaxswarm.swarm import pso
    >>> int(restart(pso(10)).init(jax.random.key(0), 3).restarts)
    0
    """
    inner = as_optimizer(inner)
    return Restart(
        inner=inner.for_one_life() if hasattr(inner, "for_one_life") else inner,
        patience=None if patience is None else coefficient("patience", patience, lower=1),
        diversity=None if diversity is None else coefficient("diversity", diversity, lower=0.0),
        keep=bool(keep),
    )
