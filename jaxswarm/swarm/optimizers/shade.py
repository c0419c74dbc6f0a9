r"""Success-history differential evolution: SHADE, and L-SHADE with its shrinking population.

Mutants follow current-to-pbest/1 with an archive of members that were replaced,

    v = x_i + F_i (x_pbest - x_i) + F_i (x_a - x_b),    a from the members, b from members and
    archive,

and every trial draws F_i from a Cauchy distribution (positive, at most 1) and CR_i from a normal
one around a remembered pair (M_F, M_CR). After a generation the oldest pair is replaced by means of
the F and CR that succeeded, weighted by the improvement (Lehmer mean for F).

L-SHADE shrinks the population linearly to 4, from as many members as the run is long enough for
(:class:`~jaxswarm.swarm.optimizers.crowd.Crowd`). Shapes are part of a compiled program, so the trials of a
step stay n. While more members than that live, a generation takes several steps, each for the next n
targets, and a trial replaces its target at once; memory, order and size of the population change when all
have had their turn. Once fewer live, member i is the target of the trials i, i + m, i + 2 m, ... and the
best of these decides. The count of evaluations stays exact.

References:
    R. Tanabe, A. Fukunaga, "Success-history based parameter adaptation for differential evolution",
    CEC 2013, doi 10.1109/CEC.2013.6557555; "Improving the search performance of SHADE using linear
    population size reduction", CEC 2014, doi 10.1109/CEC.2014.6900380.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.swarm.optimizers.base import at_least, best_of, candidate_info, comparable, dimensions
from jaxswarm.swarm.optimizers.crowd import PER_DIMENSION, Crowd, default_trials, members_at_first
from jaxswarm.swarm.optimizers.de import cross, within
from jaxswarm.swarm.optimizers.success_history import draw_pair, remember, successes
from jaxswarm.swarm.pytree import facts, pytree, static
from jaxswarm.swarm.random import Random, check_source
from jaxswarm.swarm.schedules import ScalarOrSchedule, coefficient, evaluate

__all__ = ["SHADE", "SHADEState", "shade"]

FEWEST = 4
"""Members that are always alive: a target and three others."""


@facts(MEMORY=("members", "member_value"))
class SHADEState(NamedTuple):
    """Trials, members, archive, and the memory of what succeeded.

    Attributes:
      position: (n, d) trials; trial_weight, trial_rate: (n,) their F and CR.
      first: () int32, target of the first trial; the others follow it.
      members: (N, d), the best first when a generation begins; member_value: (N,), +inf before the first
        evaluation; the first ``alive`` take part.
      archive: (N, d), of which the first ``archived`` rows are filled.
      success: (4,) sums over the successes of this generation.
      memory_weight, memory_rate: (h,) remembered M_F and M_CR; slot: the next to be replaced.
      born: () bool, whether every member has been evaluated.
    """

    position: jax.Array
    trial_weight: jax.Array
    trial_rate: jax.Array
    first: jax.Array
    members: jax.Array
    member_value: jax.Array
    alive: jax.Array
    archive: jax.Array
    archived: jax.Array
    success: jax.Array
    memory_weight: jax.Array
    memory_rate: jax.Array
    slot: jax.Array
    born: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


@pytree
class SHADE:
    """See :func:`shade` and :func:`~jaxswarm.swarm.optimizers.lshade.lshade`."""

    greediness: ScalarOrSchedule
    living: ScalarOrSchedule
    crowd: Crowd | None
    num_particles: int | None = static()
    population: int | None = static()
    num_memories: int = static()
    random: str = static()

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> SHADEState:
        """Uniform first trials; every remembered pair is (1/2, 1/2)."""
        num_dims = dimensions(num_dims)
        dtype = jnp.result_type(float if dtype is None else dtype)
        n = self.num_particles or default_trials(num_dims)
        total = max(n, self.population or self.num_particles or PER_DIMENSION * num_dims)
        position = Random(key, self.random).uniform("position", (n, num_dims), dtype)
        half, blank = jnp.asarray(0.5, dtype), jnp.zeros((total, num_dims), dtype)
        zero = jnp.zeros((), jnp.int32)
        return SHADEState(
            position=position,
            trial_weight=jnp.broadcast_to(half, (n,)),
            trial_rate=jnp.broadcast_to(half, (n,)),
            first=zero,
            members=blank,
            member_value=jnp.full((total,), jnp.inf, dtype),
            alive=jnp.asarray(total, jnp.int32),
            archive=blank,
            archived=zero,
            success=jnp.zeros((4,), dtype),
            memory_weight=jnp.broadcast_to(half, (self.num_memories,)),
            memory_rate=jnp.broadcast_to(half, (self.num_memories,)),
            slot=zero,
            born=zero > 0,
            best_position=position[0],
            best_value=jnp.asarray(jnp.inf, dtype),
            count=zero,
        )

    def update(self, key: jax.Array, state: SHADEState, value: jax.Array):
        """Select; after a generation remember, order and shrink; mutate."""
        random, dtype = Random(key, self.random), state.position.dtype
        state = state._replace(
            alive=jnp.where(state.born, state.alive, members_at_first(self.crowd, state))
        )
        value = comparable(value, state.position)
        best = best_of(state.position, value, state.best_position, state.best_value)
        best_position, best_value, improved = best

        state, gain = self._select(random, state, value)
        sums = successes(state.trial_weight, state.trial_rate, gain)
        state = state._replace(success=state.success + sums)
        complete = state.first + value.size >= state.alive
        state = jax.lax.cond(complete, self._generation, lambda s: s, state)
        first = jnp.where(complete, 0, state.first + value.size)
        greediness = evaluate("greediness", self.greediness, state.count, dtype)
        trial, weight, rate = self._trials(random, state, first, greediness)

        hyper = {"greediness": greediness, "alive": state.alive.astype(dtype)}
        info = candidate_info(state.position, value, best_value, improved, hyper)
        new = state._replace(
            position=trial,
            trial_weight=weight,
            trial_rate=rate,
            first=first,
            best_position=best_position,
            best_value=best_value,
            count=state.count + 1,
        )
        return new, info

    def _generation(self, state):
        """All members have had their turn: remember what succeeded, order, shrink."""
        first, dtype = members_at_first(self.crowd, state), state.position.dtype
        weight, rate, slot = remember(state, state.success)
        living = evaluate("living", self.living, state.count + 1, dtype)
        more = (first - FEWEST).astype(dtype)
        alive = jnp.round(FEWEST + more * jnp.clip(living, 0.0, 1.0)).astype(jnp.int32)
        order = jnp.argsort(state.member_value)
        return state._replace(
            members=state.members[order],
            member_value=state.member_value[order],
            alive=alive,
            archived=jnp.minimum(state.archived, alive),
            success=jnp.zeros_like(state.success),
            memory_weight=weight,
            memory_rate=rate,
            slot=slot,
            born=state.born | True,
        )

    def _trials(self, random, state, first, greediness):
        """Trials (n, d) for the targets from ``first`` on, with their F and CR."""
        (n, d), total, dtype = state.position.shape, state.member_value.size, state.position.dtype
        members, alive = state.members, state.alive
        weight, rate = draw_pair(random, state.memory_weight, state.memory_rate, n, dtype)
        target = (first + jnp.arange(n, dtype=jnp.int32)) % alive
        pick = random.uniform("pbest", (n,), dtype)
        elite = (pick * jnp.maximum(2.0, greediness * alive.astype(dtype))).astype(jnp.int32)
        a = random.integers("a", (n,), alive - 1)
        a = a + (a >= target).astype(jnp.int32)
        b = random.integers("b", (n,), alive + state.archived - 2)
        b = b + (b >= jnp.minimum(a, target)).astype(jnp.int32)
        b = b + (b >= jnp.maximum(a, target)).astype(jnp.int32)
        row = jnp.minimum(b, total - 1)
        other = jnp.where((b < alive)[:, None], members[row], state.archive[(b - alive) % total])
        own = members[target]
        step = (members[elite] - own) + (members[a] - other)
        trial = cross(random, own, within(own + weight[:, None] * step, own), rate[:, None])
        return jnp.where(state.born, trial, random.uniform("born", (n, d), dtype)), weight, rate

    def _select(self, random, state, value):
        """Let trials replace their targets; return what each trial gained (0: no success)."""
        n, total = value.size, state.member_value.size
        lane = jnp.arange(n, dtype=jnp.int32)
        target = (state.first + lane) % state.alive
        old = state.member_value[target]
        gain = jnp.where(jnp.isfinite(old) & (value < old), old - value, 0.0)
        # The best trial of each target decides; ties go to the first.
        lowest = jnp.full((total,), jnp.inf, value.dtype).at[target].min(value)
        tied = jnp.where(value == lowest[target], lane, n)
        leader = jnp.full((total,), n, jnp.int32).at[target].min(tied)
        winner = jnp.minimum(leader, n - 1)
        accepted = (leader < n) & (value[winner] <= state.member_value)
        members = jnp.where(accepted[:, None], state.position[winner], state.members)
        member_value = jnp.where(accepted, value[winner], state.member_value)

        retired = accepted & jnp.isfinite(state.member_value)
        place = state.archived + jnp.cumsum(retired, dtype=jnp.int32) - 1
        anywhere = random.integers("archive", (total,), state.alive)
        place = jnp.where(place < state.alive, place, anywhere)
        place = jnp.where(retired, place, total)
        archive = state.archive.at[place].set(state.members, mode="drop")
        archived = jnp.minimum(state.archived + jnp.sum(retired, dtype=jnp.int32), state.alive)
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
        living=1.0,
        crowd=None,
        num_particles=size,
        population=size,
        num_memories=at_least("num_memories", num_memories, 1, "something must be remembered"),
        random=check_source(random),
    )
