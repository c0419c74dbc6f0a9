"""Islands: several populations side by side that now and then send their best to a neighbor.

Reference:
    D. Whitley, S. Rana, R. B. Heckendorn, "The island model genetic algorithm", J. Comput. Inf.
    Technol. 7 (1999).
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError
from jaxswarm.swarm.optimizers.base import (
    as_optimizer,
    at_least,
    candidate_info,
    comparable,
    num_values,
)
from jaxswarm.swarm.optimizers.beginning import begin
from jaxswarm.swarm.pytree import pytree, replace, static
from jaxswarm.swarm.random import fold
from jaxswarm.swarm.schedules import coefficient

__all__ = ["Islands", "IslandsState", "islands"]


class IslandsState(NamedTuple):
    """States of the islands, stacked; the candidates of all of them, (num n, d)."""

    inner: Any
    position: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


@pytree
class Islands:
    """See :func:`islands`."""

    inner: Any
    migrate_every: float
    num: int = static()

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> IslandsState:
        """Islands with keys of their own."""
        inner = jax.vmap(lambda k: self.inner.init(k, num_dims, dtype=dtype))(self._keys(key))
        position = inner.position.reshape(-1, inner.position.shape[-1])
        count = jnp.zeros((), jnp.int32)
        return IslandsState(inner, position, inner.best_position[0], inner.best_value[0], count)

    def begin(self, key: jax.Array, state: IslandsState, points: jax.Array, spread: Any):
        """Every island begins at the points."""
        place = jax.vmap(lambda k, inner: begin(self.inner, k, inner, points, spread))
        inner = place(self._keys(key), state.inner)
        position = inner.position.reshape(state.position.shape)
        return state._replace(inner=inner, position=position, best_position=inner.best_position[0])

    def update(self, key: jax.Array, state: IslandsState, value: jax.Array):
        """Update every island; when it is time, the worst candidate makes room for a migrant."""
        n = state.position.shape[0]
        if num_values(self.inner) is None:
            value = comparable(value, state.position)
        elif jnp.shape(value)[:1] != (n,):
            raise InputError(
                f"value has shape {jnp.shape(value)} for {n} candidates: a row for each."
            )
        values = value.reshape(self.num, -1, *value.shape[1:])
        # Of several numbers the mean says who makes room; what is best the islands say themselves.
        value = value if value.ndim == 1 else value.mean(axis=1)
        positions = state.position.reshape(self.num, -1, state.position.shape[1])
        inner = replace(state.inner, position=positions)
        inner, infos = jax.vmap(self.inner.update)(self._keys(key), inner, values)

        leader = jnp.argmin(inner.best_value)
        improved = inner.best_value[leader] < state.best_value
        count = state.count + 1
        travel = count % jnp.asarray(self.migrate_every, jnp.int32) == 0
        migrants = jnp.roll(inner.best_position, 1, axis=0)
        worst = jnp.argmax(value.reshape(self.num, -1), axis=1)
        here = travel & (jnp.arange(values.shape[1])[None] == worst[:, None])
        positions = jnp.where(here[..., None], migrants[:, None], inner.position)
        hyper = jax.tree.map(lambda leaf: leaf[0], infos.hyper)
        best_value = inner.best_value[leader]
        info = candidate_info(state.position, value, best_value, improved, hyper)
        position = positions.reshape(state.position.shape)
        best_position = inner.best_position[leader]
        return IslandsState(inner, position, best_position, best_value, count), info

    def _keys(self, key):
        return jax.vmap(lambda i: fold(key, i))(jnp.arange(1, self.num + 1))


def islands(inner: Any, num: int = 4, *, migrate_every: int = 20) -> Islands:
    """Run ``num`` populations of ``inner``; the best of each visits the next in a circle.

    Args:
      inner: any optimizer, wrapped ones, constrained ones and those of fronts included; ``num`` times
        its candidates are evaluated a step.
      num: number of islands, at least 2.
      migrate_every: updates between two migrations.

    >>> from jaxswarm.swarm import pso
    >>> islands(pso(10), 3).init(jax.random.key(0), 2).position.shape
    (30, 2)
    """
    num = at_least("num", num, 2, "migration needs a neighbor")
    every = coefficient("migrate_every", migrate_every, lower=1)
    return Islands(as_optimizer(inner), every, num)
