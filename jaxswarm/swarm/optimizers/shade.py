r"""Success-history differential evolution: SHADE, and L-SHADE with its shrinking population.

Mutants follow current-to-pbest/1 with an archive of members that were replaced,

    v = x_i + F_i (x_pbest - x_i) + F_i (x_a - x_b),    a from the members, b from members and
    archive,

and every trial draws F_i from a Cauchy distribution (positive, at most 1) and CR_i from a normal
one around a remembered pair (M_F, M_CR). After a generation the oldest pair is replaced by means of
the F and CR that succeeded, weighted by the improvement (Lehmer mean for F).

L-SHADE shrinks the population linearly from n to 4. Shapes are part of a compiled program, so here
n trials are always evaluated: once the living members are fewer than the trials, member i is the
target of the trials i, i + m, i + 2 m, ... and the best of these decides. The count of evaluations
stays exact; in exchange for several trials a member there are fewer generations than in the
publication.

References:
    R. Tanabe, A. Fukunaga, "Success-history based parameter adaptation for differential evolution",
    CEC 2013, doi 10.1109/CEC.2013.6557555; "Improving the search performance of SHADE using linear
    population size reduction", CEC 2014, doi 10.1109/CEC.2014.6900380.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.swarm.optimizers.base import at_least, best_of, candidate_info, comparable
from jaxswarm.swarm.optimizers.de import cross, within
from jaxswarm.swarm.optimizers.success_history import draw_pair, remember
from jaxswarm.swarm.pytree import pytree, static
from jaxswarm.swarm.random import Random, check_source
from jaxswarm.swarm.schedules import ScalarOrSchedule, coefficient, evaluate, linear

__all__ = ["SHADE", "SHADEState", "lshade", "shade"]


class SHADEState(NamedTuple):
    """Trials, members in order of value, archive, and the memory of what succeeded.

    Attributes:
      position: (n, d) trials; trial_weight, trial_rate: (n,) their F and CR.
      members: (n, d) sorted, best first; member_value: (n,); the first ``alive`` take part.
      archive: (n, d), of which the first ``archived`` rows are filled.
      memory_weight, memory_rate: (h,) remembered M_F and M_CR; slot: the next to be replaced.
    """

    position: jax.Array
    trial_weight: jax.Array
    trial_rate: jax.Array
    members: jax.Array
    member_value: jax.Array
    alive: jax.Array
    archive: jax.Array
    archived: jax.Array
    memory_weight: jax.Array
    memory_rate: jax.Array
    slot: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    count: jax.Array

    MEMORY = ("members", "member_value")


@pytree
class SHADE:
    """See :func:`shade` and :func:`lshade`."""

    greediness: ScalarOrSchedule
    alive: ScalarOrSchedule
    num_particles: int = static()
    num_memories: int = static()
    random: str = static()

    def init(self, key: jax.Array, num_dims: int, dtype: Any = None) -> SHADEState:
        """Uniform first trials; every remembered pair is (1/2, 1/2)."""
        dtype = jnp.result_type(float if dtype is None else dtype)
        n = self.num_particles
        position = Random(key, self.random).uniform("position", (n, num_dims), dtype)
        half = jnp.full((self.num_memories,), 0.5, dtype)
        zero = jnp.zeros((), jnp.int32)
        return SHADEState(
            position=position,
            trial_weight=jnp.full((n,), 0.5, dtype),
            trial_rate=jnp.full((n,), 0.5, dtype),
            members=position,
            member_value=jnp.full((n,), jnp.inf, dtype),
            alive=jnp.asarray(n, jnp.int32),
            archive=position,
            archived=zero,
            memory_weight=half,
            memory_rate=half,
            slot=zero,
            best_position=position[0],
            best_value=jnp.asarray(jnp.inf, dtype),
            count=zero,
        )

    def update(self, key: jax.Array, state: SHADEState, value: jax.Array):
        """Select, remember, mutate."""
        random, dtype, n = Random(key, self.random), state.position.dtype, self.num_particles
        value = comparable(value, state.position)
        best = best_of(state.position, value, state.best_position, state.best_value)
        best_position, best_value, improved = best

        state, gain = self._select(random, state, value)
        memory = remember(state, gain)
        alive = jnp.clip(evaluate("alive", self.alive, state.count + 1, dtype), 4, n)
        alive = jnp.round(alive).astype(jnp.int32)
        order = jnp.argsort(state.member_value)
        members, member_value = state.members[order], state.member_value[order]
        archived = jnp.minimum(state.archived, alive)

        weight, rate = draw_pair(random, memory[0], memory[1], n, dtype)
        greediness = evaluate("greediness", self.greediness, state.count, dtype)
        target = jnp.arange(n, dtype=jnp.int32) % alive
        pick = random.uniform("pbest", (n,), dtype)
        elite = (pick * jnp.maximum(2.0, greediness * alive)).astype(jnp.int32)
        a = random.integers("a", (n,), alive - 1)
        a = a + (a >= target)
        b = random.integers("b", (n,), alive + archived - 2)
        b = b + (b >= jnp.minimum(a, target))
        b = b + (b >= jnp.maximum(a, target))
        other = jnp.where(
            (b < alive)[:, None], members[jnp.minimum(b, n - 1)], state.archive[(b - alive) % n]
        )
        own = members[target]
        step = (members[elite] - own) + (members[a] - other)
        trial = cross(random, own, within(own + weight[:, None] * step, own), rate[:, None])

        hyper = {"greediness": greediness, "alive": alive.astype(dtype)}
        info = candidate_info(state.position, value, best_value, improved, hyper)
        new = state._replace(
            position=trial,
            trial_weight=weight,
            trial_rate=rate,
            members=members,
            member_value=member_value,
            alive=alive,
            archived=archived,
            memory_weight=memory[0],
            memory_rate=memory[1],
            slot=memory[2],
            best_position=best_position,
            best_value=best_value,
            count=state.count + 1,
        )
        return new, info

    def _select(self, random, state, value):
        """Let trials replace their targets; return what each trial gained (0: no success)."""
        n = self.num_particles
        lane = jnp.arange(n, dtype=jnp.int32)
        target = lane % state.alive
        old = state.member_value[target]
        gain = jnp.where(jnp.isfinite(old) & (value < old), old - value, 0.0)
        # The best trial of each target decides; ties go to the first.
        lowest = jnp.full((n,), jnp.inf, value.dtype).at[target].min(value)
        first = (
            jnp.full((n,), n, jnp.int32).at[target].min(jnp.where(value == lowest[target], lane, n))
        )
        winner = jnp.minimum(first, n - 1)
        accepted = (lane < state.alive) & (first < n) & (value[winner] <= state.member_value)
        members = jnp.where(accepted[:, None], state.position[winner], state.members)
        member_value = jnp.where(accepted, value[winner], state.member_value)

        retired = accepted & jnp.isfinite(state.member_value)
        place = state.archived + jnp.cumsum(retired) - 1
        anywhere = random.integers("archive", (n,), state.alive)
        place = jnp.where(place < state.alive, place, anywhere)
        archive = state.archive.at[jnp.where(retired, place, n)].set(state.members, mode="drop")
        archived = jnp.minimum(state.archived + jnp.sum(retired), state.alive)
        new = state._replace(
            members=members,
            member_value=member_value,
            archive=archive,
            archived=archived.astype(jnp.int32),
        )
        return new, gain


def shade(
    num_particles: int = 60,
    *,
    greediness: ScalarOrSchedule = 0.11,
    num_memories: int = 20,
    random: str = "hash",
) -> SHADE:
    """Differential evolution that learns F and CR from its successes; n stays the same.

    Args:
      num_particles: n, at least 8.
      greediness: p, share of the best members among which a target's guide is drawn.
      num_memories: pairs (M_F, M_CR) remembered.
      random: ``"hash"`` or ``"threefry"``.

    >>> shade(20).init(jax.random.key(0), 3).position.shape
    (20, 3)
    """
    size = at_least("num_particles", num_particles, 8, "a mutant takes members and an archive")
    return SHADE(
        greediness=coefficient("greediness", greediness, lower=0.0, upper=1.0),
        alive=float(size),
        num_particles=size,
        num_memories=at_least("num_memories", num_memories, 1, "something must be remembered"),
        random=check_source(random),
    )


def lshade(num_particles: int = 60, num_steps: float | None = None, **options: Any) -> SHADE:
    """SHADE whose population falls linearly to 4 over ``num_steps``, with six remembered pairs.

    Args:
      num_particles: n, members at the start and trials in every step, at least 8.
      num_steps: updates over which the population shrinks; default as many as ``minimize`` makes.
      **options: keyword arguments of :func:`shade`.
    """
    optimizer = shade(num_particles, **(dict(num_memories=6) | options))
    return SHADE(
        greediness=optimizer.greediness,
        alive=linear(float(num_particles), 4.0, num_steps),
        num_particles=optimizer.num_particles,
        num_memories=optimizer.num_memories,
        random=optimizer.random,
    )
