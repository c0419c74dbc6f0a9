"""NSGA-II: survival by front and crowding, with the genetic operators of ``ga``.

The objective returns ``num_objectives`` values, an array (k,) or a tuple. ``front(result, space)`` gives
the front; ``result.value`` and ``result.params`` are the candidate with the lowest mean of objectives.

Reference:
    K. Deb, A. Pratap, S. Agarwal, T. Meyarivan, "A fast and elitist multiobjective genetic algorithm:
    NSGA-II", IEEE Trans. Evol. Comput. 6 (2002), doi 10.1109/4235.996017.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.swarm.calling import part_of
from jaxswarm.swarm.objectives import lowest_mean, objectives_of
from jaxswarm.swarm.optimizers.base import at_least, candidate_info, dimensions
from jaxswarm.swarm.optimizers.operators import polynomial, sbx, tournament
from jaxswarm.swarm.pareto import survivors
from jaxswarm.swarm.pytree import facts, pytree, static
from jaxswarm.swarm.random import Random, check_source

__all__ = ["NSGA2", "NSGA2State", "nsga2"]


@facts(FRONT=("parents", "parent_values"))
class NSGA2State(NamedTuple):
    """Children to evaluate (n, d); parents (n, d), best first, with values (n, k); the best mean."""

    position: jax.Array
    parents: jax.Array
    parent_values: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


@pytree
class NSGA2:
    """See :func:`nsga2`."""

    selection: Any
    crossover: Any
    mutation: Any
    num_values: int = static()
    num_particles: int = static()
    random: str = static()

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> NSGA2State:
        """Uniform first children; no parents yet."""
        num_dims = dimensions(num_dims)
        dtype = jnp.result_type(float if dtype is None else dtype)
        n = self.num_particles
        position = Random(key, self.random).uniform("position", (n, num_dims), dtype)
        values = jnp.full((n, self.num_values), jnp.inf, dtype)
        zero = jnp.zeros((), jnp.int32)
        return NSGA2State(position, position, values, position[0], values[0, 0], zero)

    def update(self, key: jax.Array, state: NSGA2State, value: jax.Array):
        """Survive by front and crowding, select, cross, mutate."""
        random, n = Random(key, self.random), self.num_particles
        value = objectives_of(state, value, self.num_values)
        best, improved = lowest_mean(state, value)
        merged = jnp.concatenate([state.position, state.parents])
        values = jnp.concatenate([value, state.parent_values])
        chosen = survivors(values, n)
        parents, values = merged[chosen], values[chosen]

        place = jnp.arange(n, dtype=value.dtype)  # crowded comparison: who survives earlier wins
        first, second = self.selection(random, place)[:, : (n + 1) // 2]
        children = self.crossover(random, parents[first], parents[second])[:n]
        children = self.mutation(random, children)
        info = candidate_info(state.position, value.mean(axis=1), best[1], improved, {})
        return NSGA2State(children, parents, values, *best, state.count + 1), info


def nsga2(
    num_objectives: int = 2,
    num_particles: int = 100,
    *,
    selection: Any = None,
    crossover: Any = None,
    mutation: Any = None,
    random: str = "hash",
) -> NSGA2:
    """NSGA-II: survival by front and crowding, the operators of ``ga``.

    Args:
      num_objectives: k, at least 2.
      num_particles: n, children a generation, at least 4; the front has at most as many candidates.
      selection, crossover, mutation: parts of ``operators``; default ``tournament(2)``,
        ``sbx(eta=15)``, ``polynomial(eta=20)``.
      random: ``"hash"`` or ``"threefry"``.

    >>> from jaxswarm.swarm import Space, minimize
    >>> two = lambda p, _: (p["x"] ** 2, (p["x"] - 1.0) ** 2)
    >>> space = Space(x=(-4.0, 4.0))
    >>> found = minimize(two, nsga2(2, 20), space, jax.random.key(0), num_steps=30)
    >>> values = found.state.parent_values
    >>> bool((abs(jnp.sqrt(values).sum(axis=1) - 1.0) < 1e-2).all())
    True
    """
    return NSGA2(
        selection=part_of("selection", selection or tournament(2), "random", "value"),
        crossover=part_of("crossover", crossover or sbx(), "random", "first", "second"),
        mutation=part_of("mutation", mutation or polynomial(), "random", "position"),
        num_values=at_least("num_objectives", num_objectives, 2, "one objective has no front"),
        num_particles=at_least(
            "num_particles", num_particles, 4, "two pairs of parents are needed"
        ),
        random=check_source(random),
    )
