"""Who listens to whom: from the memories of a swarm, the attractor of every particle.

A topology is any function ``(random, memory_position (n, d), memory_value (n,)) -> attractor (n,
d)``. ``random`` stays the same while the swarm improves and changes after a step without
improvement, so a random graph lasts exactly as long as it serves.

References:
    J. Kennedy, R. Mendes, "Population structure and particle swarm performance", CEC 2002 (ring,
    von Neumann); M. Clerc, "Standard particle swarm optimisation", 2012, hal-00764996 (random
    informants).
"""

import math

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.swarm.optimizers.base import at_least
from jaxswarm.swarm.pytree import pytree, static

__all__ = ["global_best", "random_informants", "ring", "von_neumann"]


def global_best() -> "GlobalBest":
    """Every particle follows the best memory of the swarm: fast, and first to settle."""
    return GlobalBest()


def ring(reach: int = 1) -> "Ring":
    """Every particle follows the best among itself and ``reach`` neighbors on either side."""
    return Ring(at_least("reach", reach, 1, "a ring links neighbors"))


def von_neumann(rows: int | None = None) -> "VonNeumann":
    """Particles on a torus grid follow the best of themselves and their four neighbors.

    Args:
      rows: rows of the grid, a divisor of the number of particles; default the one nearest to a
        square.
    """
    return VonNeumann(rows if rows is None else at_least("rows", rows, 1, "a grid has rows"))


def random_informants(num: int = 3) -> "RandomInformants":
    """Every particle informs ``num`` others drawn at random, and itself (SPSO 2007 and 2011)."""
    return RandomInformants(at_least("num", num, 1, "each particle informs some others"))


@pytree
class GlobalBest:
    """See :func:`global_best`."""

    def __call__(self, random, memory_position, memory_value):
        leader = jnp.argmin(memory_value)
        return jnp.broadcast_to(memory_position[leader], memory_position.shape)


@pytree
class Ring:
    """See :func:`ring`."""

    reach: int = static()

    def __call__(self, random, memory_position, memory_value):
        num = memory_value.shape[0]
        offsets = np.arange(-self.reach, self.reach + 1)
        return _follow((np.arange(num)[:, None] + offsets) % num, memory_position, memory_value)


@pytree
class VonNeumann:
    """See :func:`von_neumann`."""

    rows: int | None = static()

    def __call__(self, random, memory_position, memory_value):
        num = memory_value.shape[0]
        rows = self.rows or max(r for r in range(1, math.isqrt(num) + 1) if num % r == 0)
        if num % rows:
            raise InputError(f"rows={rows} does not divide num_particles={num}.")
        grid = np.arange(num).reshape(rows, -1)
        shifted = [np.roll(grid, s, axis=a) for a in (0, 1) for s in (1, -1)]
        neighbors = np.stack([grid, *shifted], axis=-1).reshape(num, -1)
        return _follow(neighbors, memory_position, memory_value)


@pytree
class RandomInformants:
    """See :func:`random_informants`."""

    num: int = static()

    def __call__(self, random, memory_position, memory_value):
        size = memory_value.shape[0]
        told = random.integers("informants", (size, self.num), size)
        told = jnp.concatenate([told, jnp.arange(size, dtype=told.dtype)[:, None]], axis=1)
        # The best of those that inform a particle, by rank: one scatter instead of an (n, n) graph.
        order = jnp.argsort(memory_value)
        rank = jnp.zeros(size, jnp.int32).at[order].set(jnp.arange(size, dtype=jnp.int32))
        ranks = jnp.broadcast_to(rank[:, None], told.shape)
        best = jnp.full(size, size, jnp.int32).at[told.ravel()].min(ranks.ravel())
        return memory_position[order[best]]


def _follow(
    neighbors: np.ndarray, memory_position: jax.Array, memory_value: jax.Array
) -> jax.Array:
    """Attractors for a fixed graph: ``neighbors`` (n, k) holds the indices each particle sees."""
    best = jnp.argmin(memory_value[neighbors], axis=1)
    return memory_position[jnp.take_along_axis(jnp.asarray(neighbors), best[:, None], axis=1)[:, 0]]
