"""Random search: candidates uniform in the cube, the yardstick that anything must beat.

Reference:
    J. Bergstra, Y. Bengio, "Random search for hyper-parameter optimization", JMLR 13 (2012).
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.swarm.optimizers.base import at_least, best_of, candidate_info, comparable, dimensions
from jaxswarm.swarm.pytree import pytree, static
from jaxswarm.swarm.random import Random, check_source

__all__ = ["RandomSearch", "RandomSearchState", "random_search"]


class RandomSearchState(NamedTuple):
    """Candidates (n, d), best candidate (d,) and its value, updates done."""

    position: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


@pytree
class RandomSearch:
    """See :func:`random_search`."""

    num_particles: int = static()
    random: str = static()

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> RandomSearchState:
        """Uniform candidates."""
        num_dims = dimensions(num_dims)
        dtype = jnp.result_type(float if dtype is None else dtype)
        shape = (self.num_particles, num_dims)
        position = Random(key, self.random).uniform("position", shape, dtype)
        best_value = jnp.asarray(jnp.inf, dtype)
        return RandomSearchState(position, position[0], best_value, jnp.zeros((), jnp.int32))

    def update(self, key: jax.Array, state: RandomSearchState, value: jax.Array):
        """Keep the best and draw anew."""
        dtype = state.position.dtype
        value = comparable(value, state.position)
        best = best_of(state.position, value, state.best_position, state.best_value)
        best_position, best_value, improved = best
        position = Random(key, self.random).uniform("position", state.position.shape, dtype)
        info = candidate_info(state.position, value, best_value, improved, {})
        return RandomSearchState(position, best_position, best_value, state.count + 1), info


def random_search(num_particles: int = 40, *, random: str = "hash") -> RandomSearch:
    """Uniform random candidates, ``num_particles`` at a time.

    >>> random_search(10).init(jax.random.key(0), 3).position.shape
    (10, 3)
    """
    size = at_least("num_particles", num_particles, 1, "a step needs a candidate")
    return RandomSearch(size, check_source(random))
