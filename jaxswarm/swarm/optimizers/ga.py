"""Real-coded genetic algorithms, assembled from selection, crossover and mutation.

One generation: the children just evaluated join the ``num_elites`` best parents, the best n of them
become parents, pairs of parents are selected, crossed and mutated to n children. With all parents
as elites this is the (mu + lambda) survival of today's libraries, with one or two the textbook's
elitism.

References: see ``operators``.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError
from jaxswarm.swarm.calling import part_of
from jaxswarm.swarm.optimizers.base import at_least, best_of, candidate_info, comparable, dimensions
from jaxswarm.swarm.optimizers.operators import (
    arithmetic,
    polynomial,
    roulette,
    sbx,
    tournament,
    uniform,
)
from jaxswarm.swarm.pytree import facts, pytree, static
from jaxswarm.swarm.random import Random, check_source

__all__ = ["GA", "GAState", "ga", "textbook_ga"]


@facts(MEMORY=("parents", "parent_value"))
class GAState(NamedTuple):
    """Children to evaluate (n, d), parents (n, d) with values (n,), the best so far.

    Parents have the value +inf before the first evaluation.
    """

    position: jax.Array
    parents: jax.Array
    parent_value: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


@pytree
class GA:
    """A genetic algorithm; build it with :func:`ga` or :func:`textbook_ga`."""

    selection: Any
    crossover: Any
    mutation: Any
    num_particles: int = static()
    num_elites: int = static()
    random: str = static()

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> GAState:
        """Uniform first children; no parents yet."""
        num_dims = dimensions(num_dims)
        dtype = jnp.result_type(float if dtype is None else dtype)
        shape = (self.num_particles, num_dims)
        position = Random(key, self.random).uniform("position", shape, dtype)
        infinite = jnp.full(shape[:1], jnp.inf, dtype)
        zero = jnp.zeros((), jnp.int32)
        return GAState(position, position, infinite, position[0], infinite[0], zero)

    def update(self, key: jax.Array, state: GAState, value: jax.Array):
        """Survive, select, cross, mutate."""
        random, n = Random(key, self.random), self.num_particles
        value = comparable(value, state.position)
        best = best_of(state.position, value, state.best_position, state.best_value)
        best_position, best_value, improved = best

        elite = jnp.argsort(state.parent_value)[: self.num_elites]
        merged = jnp.concatenate([state.position, state.parents[elite]])
        merged_value = jnp.concatenate([value, state.parent_value[elite]])
        survivors = jnp.argsort(merged_value)[:n]
        parents, parent_value = merged[survivors], merged_value[survivors]

        pairs = (n + 1) // 2
        first, second = self.selection(random, parent_value)[:, :pairs]
        children = self.crossover(random, parents[first], parents[second])[:n]
        children = self.mutation(random, children)
        info = candidate_info(state.position, value, best_value, improved, {})
        new = GAState(children, parents, parent_value, best_position, best_value, state.count + 1)
        return new, info


def ga(
    num_particles: int = 50,
    *,
    num_elites: int | None = None,
    selection: Any = None,
    crossover: Any = None,
    mutation: Any = None,
    random: str = "hash",
) -> GA:
    """Real-coded genetic algorithm: binary tournament, SBX, polynomial mutation.

    Args:
      num_particles: n, children a generation, at least 4.
      num_elites: parents that compete with the children; default all of them.
      selection: ``tournament(2)`` or another part of ``operators``.
      crossover: default ``sbx(eta=15, rate=0.9)``.
      mutation: default ``polynomial(eta=20)`` with rate 1/d.
      random: ``"hash"`` or ``"threefry"``.

    >>> ga(20).init(jax.random.key(0), 3).position.shape
    (20, 3)
    """
    size = at_least("num_particles", num_particles, 4, "two pairs of parents are needed")
    elites = size if num_elites is None else at_least("num_elites", num_elites, 0, "none is least")
    if elites > size:
        raise InputError(f"num_elites={elites} is more than num_particles={size}.")
    return GA(
        selection=part_of("selection", selection or tournament(2), "random", "value"),
        crossover=part_of("crossover", crossover or sbx(), "random", "first", "second"),
        mutation=part_of("mutation", mutation or polynomial(), "random", "position"),
        num_particles=size,
        num_elites=elites,
        random=check_source(random),
    )


def textbook_ga(num_particles: int = 200, **parts: Any) -> GA:
    """The textbook form: roulette, arithmetic crossover 0.8, uniform mutation 0.1, one elite.

    Args:
      num_particles: n, at least 4.
      **parts: keyword arguments of :func:`ga`, which override the choices made here.
    """
    chosen: dict[str, Any] = dict(
        selection=roulette(), crossover=arithmetic(0.8), mutation=uniform(0.1)
    )
    return ga(num_particles, **(chosen | dict(num_elites=1) | parts))
