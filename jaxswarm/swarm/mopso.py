"""MOPSO: a particle swarm whose leaders come from an archive of the front, the roomier places first.

Velocity rule, walls and mutation are those of ``pso`` and ``ga``. The objective and the results are as for
``nsga2``.

References:
    C. A. Coello Coello, G. T. Pulido, M. S. Lechuga, "Handling multiple objectives with particle swarm
    optimization", IEEE Trans. Evol. Comput. 8 (2004), doi 10.1109/TEVC.2004.826067 (archive, leaders from
    it); M. R. Sierra, C. A. Coello Coello, "Improving PSO-based multi-objective optimization using
    crowding, mutation and epsilon-dominance", EMO 2005, doi 10.1007/978-3-540-31880-4_35 (crowded leaders,
    mutation).
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.swarm.calling import check_shape, part_of
from jaxswarm.swarm.objectives import lowest_mean, objectives_of
from jaxswarm.swarm.optimizers.base import at_least, candidate_info, dimensions
from jaxswarm.swarm.optimizers.boundaries import reflect
from jaxswarm.swarm.optimizers.operators import polynomial
from jaxswarm.swarm.optimizers.particles import BOUNDARY, RULE, within
from jaxswarm.swarm.optimizers.rules import Swarm, canonical
from jaxswarm.swarm.pareto import crowding, dominates, ranks
from jaxswarm.swarm.pytree import facts, pytree, static
from jaxswarm.swarm.random import Random, check_source
from jaxswarm.swarm.schedules import ScalarOrSchedule, coefficient, evaluate

__all__ = ["MOPSO", "MOPSOState", "mopso"]


@facts(FRONT=("archive", "archive_values"))
class MOPSOState(NamedTuple):
    """A swarm with values (n, k) of its memories, and an archive (a, d) with values (a, k).

    Rows of the archive that are not filled have the values +inf.
    """

    position: jax.Array
    velocity: jax.Array
    memory_position: jax.Array
    memory_values: jax.Array
    archive: jax.Array
    archive_values: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


@pytree
class MOPSO:
    """See :func:`mopso`."""

    inertia: ScalarOrSchedule
    cognitive: ScalarOrSchedule
    social: ScalarOrSchedule
    turbulent: Any
    rule: Any
    boundary: Any
    mutation: Any
    num_values: int = static()
    num_particles: int = static()
    size: int = static()
    random: str = static()

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> MOPSOState:
        """Uniform positions at rest; an empty archive."""
        num_dims = dimensions(num_dims)
        dtype = jnp.result_type(float if dtype is None else dtype)
        n, k = self.num_particles, self.num_values
        position = Random(key, self.random).uniform("position", (n, num_dims), dtype)
        return MOPSOState(
            position=position,
            velocity=jnp.zeros_like(position),
            memory_position=position,
            memory_values=jnp.full((n, k), jnp.inf, dtype),
            archive=jnp.zeros((self.size, num_dims), dtype),
            archive_values=jnp.full((self.size, k), jnp.inf, dtype),
            best_position=position[0],
            best_value=jnp.asarray(jnp.inf, dtype),
            count=jnp.zeros((), jnp.int32),
        )

    def update(self, key: jax.Array, state: MOPSOState, value: jax.Array):
        """Remember, archive, choose leaders where the front is empty, move, disturb some."""
        random, dtype = Random(key, self.random), state.position.dtype
        value = objectives_of(state, value, self.num_values)
        best, improved = lowest_mean(state, value)
        n = self.num_particles
        # Of two that do not dominate each other either is kept, by a coin.
        coin = random.uniform("memory", (n,), dtype) < 0.5
        better = dominates(value, state.memory_values)
        better = better | (coin & ~dominates(state.memory_values, value))
        memory = jnp.where(better[:, None], state.position, state.memory_position)
        memory_values = jnp.where(better[:, None], value, state.memory_values)
        archive, values, empty = self._archived(state, value)
        swarm = Swarm(
            position=state.position,
            velocity=state.velocity,
            memory_position=memory,
            attractor=archive[self._leaders(random, empty)],
            value=value.mean(axis=1),
            improved=better,
            memory_value=memory_values.mean(axis=1),
        )
        names = ("inertia", "cognitive", "social")
        hyper = {name: evaluate(name, getattr(self, name), state.count, dtype) for name in names}
        velocity = check_shape("rule", self.rule(random, swarm, hyper), state.position.shape)
        moved = within(self.boundary, random, state.position + velocity, velocity)
        disturbed = random.uniform("turbulent", (n, 1), dtype) < self.turbulent
        position = jnp.where(disturbed, self.mutation(random, moved[0]), moved[0])
        info = candidate_info(state.position, value.mean(axis=1), best[1], improved, hyper)
        new = (position, moved[1], memory, memory_values, archive, values)
        return MOPSOState(*new, *best, state.count + 1), info

    def _archived(self, state, value):
        """The archive with what is new on the front, and the room around each (0 where not filled)."""
        places = jnp.concatenate([state.archive, state.position])
        values = jnp.concatenate([state.archive_values, value])
        # A candidate that came back to where the front has been adds nothing to it.
        equal = jnp.all(values[:, None] == values[None], axis=-1)
        again = jnp.any(jnp.tril(equal, -1), axis=1)
        values = jnp.where(again[:, None], jnp.inf, values)
        rank = ranks(values)
        chosen = jnp.lexsort((-crowding(values, rank), rank))[: self.size]
        lasts = (rank[chosen] == 0) & jnp.isfinite(values[chosen]).all(axis=1)
        kept = jnp.where(lasts[:, None], values[chosen], jnp.inf)
        room = jnp.where(lasts, crowding(kept, jnp.where(lasts, 0, 1)), 0.0)
        return places[chosen], kept, room

    def _leaders(self, random, room):
        """Indices (n,) into the archive, each the roomier of two drawn among those that are filled."""
        filled = jnp.maximum(jnp.sum(room > 0.0), 1)
        order = jnp.argsort(-room)
        pair = order[random.integers("leaders", (2, self.num_particles), filled)]
        return jnp.where(room[pair[0]] >= room[pair[1]], pair[0], pair[1])


def mopso(
    num_objectives: int = 2,
    num_particles: int = 100,
    *,
    size: int = 100,
    inertia: ScalarOrSchedule = 0.4,
    cognitive: ScalarOrSchedule = 1.5,
    social: ScalarOrSchedule = 1.5,
    turbulent: float = 0.15,
    rule: Any = None,
    boundary: Any = None,
    mutation: Any = None,
    random: str = "hash",
) -> MOPSO:
    """Multi-objective particle swarm: leaders from an archive of the front, the roomier ones first.

    Args:
      num_objectives: k, at least 2.
      num_particles: n, at least 2.
      size: rows of the archive; what is most crowded leaves it first.
      inertia, cognitive, social, rule, boundary: as for ``pso``.
      turbulent: share of the particles that ``mutation`` disturbs after a move.
      mutation: a part of ``operators``; default ``polynomial(eta=20)``.
      random: ``"hash"`` or ``"threefry"``.

    >>> mopso(2, 10, size=20).init(jax.random.key(0), 3).archive.shape
    (20, 3)
    """
    return MOPSO(
        inertia=coefficient("inertia", inertia),
        cognitive=coefficient("cognitive", cognitive),
        social=coefficient("social", social),
        turbulent=coefficient("turbulent", turbulent, lower=0.0, upper=1.0),
        rule=part_of("rule", rule or canonical(), *RULE),
        boundary=part_of("boundary", boundary or reflect(0.5), *BOUNDARY),
        mutation=part_of("mutation", mutation or polynomial(), "random", "position"),
        num_values=at_least("num_objectives", num_objectives, 2, "one objective has no front"),
        num_particles=at_least(
            "num_particles", num_particles, 2, "particles learn from each other"
        ),
        size=at_least("size", size, 2, "a front has two ends"),
        random=check_source(random),
    )
