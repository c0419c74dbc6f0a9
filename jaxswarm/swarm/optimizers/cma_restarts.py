r"""CMA-ES that begins anew when it has ended, with larger populations: IPOP and BIPOP.

IPOP doubles the population with every life. BIPOP alternates, so that both kinds get as many
evaluations: lives of the large kind double it, lives of the small kind take

    n_small = n floor((k / 2)^(u^2)),   sigma = 10^(-2 v) sigma_0,   u, v uniform in (0, 1),

where k n was the last large population, and at most half as many evaluations as the large lives
have had together. A life ends by the
criteria of :mod:`~jaxswarm.swarm.optimizers.cma_termination`.

Shapes are part of a compiled program, so the candidates of a step stay n and a population of k n is
evaluated in k steps; then the distribution moves. Nothing is evaluated in vain, and a machine that
evaluates n candidates side by side is always full.

Deviation: sizes are multiples of n, and the population grows at most ``num_doublings`` times.

References:
    A. Auger, N. Hansen, "A restart CMA evolution strategy with increasing population size", CEC
    2005, doi 10.1109/CEC.2005.1554902; N. Hansen, "Benchmarking a BI-population CMA-ES on the
    BBOB-2009 function testbed", GECCO 2009, doi 10.1145/1570256.1570333.
"""

from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.swarm.optimizers.base import at_least, best_of, candidate_info, comparable
from jaxswarm.swarm.optimizers.cma_distribution import (
    Distribution,
    Rates,
    adapt,
    deviations,
    draw,
    round_at,
)
from jaxswarm.swarm.optimizers.cma_es import CMAES, cma_es
from jaxswarm.swarm.optimizers.cma_termination import Watch, unwatched, watch
from jaxswarm.swarm.optimizers.outside import evaluated, inside, ranks
from jaxswarm.swarm.pytree import pytree, static
from jaxswarm.swarm.random import Random

__all__ = ["CMARestarts", "CMARestartsState", "bipop_cma_es", "ipop_cma_es"]

NUM_DOUBLINGS = 7
"""Population up to 128 n: twice what IPOP reaches on BBOB in 20 dimensions with 10,000 D evaluations."""

TIER, PROVEN = 3, 0.5
"""Doublings from one compiled size of a generation to the next: eight times the rows. Share of the updates
of an ended life, on average, from which on the mean of a life is recommended."""


class Life(NamedTuple):
    """What distinguishes this life from others; all scalars.

    Attributes:
      size: int32, k: the population is k n.
      small: bool, whether it is of the small kind.
      steps: float, updates done in it; limit: float, updates after which it ends, inf for none.
      sigma: first step size.
    """

    size: jax.Array
    small: jax.Array
    steps: jax.Array
    limit: jax.Array
    sigma: jax.Array


class CMARestartsState(NamedTuple):
    """Candidates (n, d) of this step, and what was evaluated of this generation.

    Attributes:
      pool: (rows, d) samples of the generation; pool_value: (rows,); the first ``filled`` n count.
      search, watch: as in ``CMAESState``, of this life.
      life: this life; doublings: () int32, of the large kind so far.
      spent: (2,) updates in ended lives of the large and of the small kind.
      restarts: () int32, lives ended so far.
    """

    position: jax.Array
    sample: jax.Array
    pool: jax.Array
    pool_value: jax.Array
    filled: jax.Array
    search: Distribution
    watch: Watch
    life: Life
    doublings: jax.Array
    spent: jax.Array
    restarts: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple

    @property
    def mean(self) -> jax.Array:
        """(d,) mean of this life; the best position while it is young, beside those that have ended."""
        lives = self.restarts.astype(self.spent.dtype)
        proven = self.life.steps * lives >= PROVEN * jnp.sum(self.spent)
        return jnp.where(proven, self.search.mean, self.best_position)


@pytree
class CMARestarts:
    """See :func:`ipop_cma_es` and :func:`bipop_cma_es`."""

    inner: CMAES
    two_kinds: bool = static()
    num_doublings: int = static()

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> CMARestartsState:
        """The first life: that of ``cma_es``."""
        first = self.inner.init(key, num_dims, dtype)
        (n, d), dtype = first.position.shape, first.position.dtype
        rows = n * 2**self.num_doublings
        zero, nothing = jnp.zeros((), jnp.int32), jnp.zeros((), dtype)
        # As in pycma the first life counts among the small ones.
        small = jnp.asarray(self.two_kinds)
        return CMARestartsState(
            position=first.position,
            sample=first.sample,
            pool=jnp.zeros((rows, d), dtype),
            pool_value=jnp.zeros((rows,), dtype),
            filled=zero,
            search=first.search,
            watch=first.watch,
            life=Life(zero + 1, small, nothing, jnp.asarray(jnp.inf, dtype), first.search.sigma),
            doublings=zero,
            spent=jnp.zeros((2,), dtype),
            restarts=zero,
            best_position=first.best_position,
            best_value=first.best_value,
            count=zero,
        )

    def update(self, key: jax.Array, state: CMARestartsState, value: jax.Array):
        """Collect a part of the generation; if it is complete, adapt or begin anew; draw."""
        random, n = Random(key, self.inner.random), state.position.shape[0]
        value = comparable(value, state.position)
        best = best_of(state.position, value, state.best_position, state.best_value)
        best_position, best_value, improved = best

        part = evaluated(state.sample, state.position)
        row = state.filled * n
        pool = jax.lax.dynamic_update_slice(state.pool, part, (row, jnp.int32(0)))
        pool_value = jax.lax.dynamic_update_slice(state.pool_value, value, (row,))
        life = state.life._replace(steps=state.life.steps + 1.0)
        complete = state.filled + 1 >= life.size
        search, seen = jax.lax.cond(
            complete,
            lambda: self._generation(state, pool, pool_value, n),
            lambda: (state.search, state.watch),
        )
        ended = complete & ((seen.code > 0) | (life.steps >= life.limit))
        going = state._replace(search=search, watch=seen, life=life)
        going = jax.lax.cond(ended, lambda: self._anew(random, going), lambda: going)

        sample = draw(random, going.search, n)
        hyper = {
            "sigma": going.search.sigma,
            "population": (n * going.life.size).astype(value.dtype),
            "restarts": going.restarts.astype(value.dtype),
        }
        info = candidate_info(state.position, value, best_value, improved, hyper)
        new = going._replace(
            position=inside(sample),
            sample=sample,
            pool=pool,
            pool_value=pool_value,
            filled=jnp.where(complete, 0, state.filled + 1),
            best_position=best_position,
            best_value=best_value,
            count=state.count + 1,
        )
        return new, info

    def _generation(self, state, pool, pool_value, n):
        """The distribution after a complete generation, and whether it has ended."""
        # Most generations are small: work on as many rows as a program for some sizes needs.
        tiers = [n * 2**power for power in range(self.num_doublings, -1, -TIER)][::-1]
        size = n * state.life.size
        of_rows = [partial(self._of_rows, state, pool[:r], pool_value[:r], size) for r in tiers]
        return jax.lax.switch(jnp.searchsorted(jnp.array(tiers, jnp.int32), size), of_rows)

    def _of_rows(self, state, pool, pool_value, size):
        rows, d = pool.shape
        spread = jnp.sqrt(jnp.mean(deviations(state.search) ** 2))
        order = ranks(pool, pool_value, spread, size)
        search = adapt(state.search, pool[order], Rates.among(rows, size, d, pool.dtype))
        value = jnp.sort(jnp.where(jnp.arange(rows, dtype=jnp.int32) < size, pool_value, jnp.inf))
        limits = state.life.sigma, self.inner.tol_x, self.inner.tol_fun
        return search, watch(state.watch, search, value, size, *limits)

    def _anew(self, random, state):
        """The next life: its kind, population and step size, at a uniform point."""
        (d,), dtype, life = state.search.mean.shape, state.search.mean.dtype, state.life
        spent = state.spent.at[life.small.astype(jnp.int32)].add(life.steps)
        small = self.two_kinds & (spent[1] < spent[0])
        doublings = jnp.minimum(state.doublings + (~small).astype(jnp.int32), self.num_doublings)
        u, v = random.uniform("life", (2,), dtype)
        largest = 2.0 ** doublings.astype(dtype)
        size = jnp.where(small, jnp.floor(jnp.maximum(0.5 * largest, 1.0) ** (u**2)), largest)
        sigma = self.inner.sigma * jnp.where(small, 10.0 ** (-2.0 * v), 1.0)
        limit = jnp.where(small, 0.5 * spent[0], jnp.inf)
        zero = jnp.zeros((), dtype)
        life = Life(size.astype(jnp.int32), small, zero, limit.astype(dtype), sigma.astype(dtype))
        return state._replace(
            search=round_at(random.uniform("mean", (d,), dtype), sigma),
            watch=unwatched(state.position.shape[0], d, dtype),
            life=life,
            doublings=doublings.astype(jnp.int32),
            spent=spent,
            restarts=state.restarts + 1,
        )


def ipop_cma_es(
    num_particles: int | None = None, *, num_doublings: int = NUM_DOUBLINGS, **options: Any
) -> CMARestarts:
    """CMA-ES with restarts that double the population, for many local optima.

    Args:
      num_particles: n, candidates of a step and population of the first life; default as for
        :func:`cma_es`.
      num_doublings: how often the population grows; the memory for it is reserved.
      **options: keyword arguments of :func:`cma_es`.

    >>> ipop_cma_es().init(jax.random.key(0), 13).pool.shape
    (1408, 13)
    """
    num = at_least("num_doublings", num_doublings, 0, "a population cannot shrink")
    return CMARestarts(cma_es(num_particles, **options), False, num)


def bipop_cma_es(
    num_particles: int | None = None, *, num_doublings: int = NUM_DOUBLINGS, **options: Any
) -> CMARestarts:
    """CMA-ES with restarts of growing and of small populations in turn: when nothing is known.

    Args:
      num_particles, num_doublings, **options: as for :func:`ipop_cma_es`.

    >>> int(bipop_cma_es(8).init(jax.random.key(0), 3).life.size)
    1
    """
    num = at_least("num_doublings", num_doublings, 0, "a population cannot shrink")
    return CMARestarts(cma_es(num_particles, **options), True, num)
