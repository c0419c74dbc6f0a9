r"""SNES: a separable normal distribution that follows its natural gradient.

With x_i = m + s z_i, z_i ~ N(0, I), and utilities by rank k = 1 (the best) ... n,

    u_k  = max(0, ln(n/2 + 1) - ln k) / sum_j max(0, ln(n/2 + 1) - ln j) - 1/n
    m   <- m + s sum_i u_i z_i
    s   <- s exp(1/2 eta sum_i u_i (z_i^2 - 1)),      eta = (3 + ln d) / (5 sqrt(d))

elementwise. Walls as for ``cma_es``.

Reference:
    T. Schaul, T. Glasmachers, J. Schmidhuber, "High dimensions and heavy tails for natural evolution
    strategies", GECCO 2011, doi 10.1145/2001576.2001692.
"""

import math
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.swarm.optimizers.base import at_least, best_of, candidate_info, comparable, dimensions
from jaxswarm.swarm.optimizers.cma_distribution import LARGEST
from jaxswarm.swarm.optimizers.cma_es import default_population
from jaxswarm.swarm.optimizers.outside import evaluated, inside, ranks
from jaxswarm.swarm.pytree import pytree, static
from jaxswarm.swarm.random import Random, check_source
from jaxswarm.swarm.schedules import coefficient

__all__ = ["SNES", "SNESState", "snes", "utilities"]


class SNESState(NamedTuple):
    """Candidates (n, d), the samples (n, d) as drawn, mean and standard deviations (d,)."""

    position: jax.Array
    sample: jax.Array
    mean: jax.Array
    spread: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


@pytree
class SNES:
    """See :func:`snes`."""

    sigma: Any
    num_particles: int | None = static()
    random: str = static()

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> SNESState:
        """Round distribution around a uniform point."""
        num_dims = dimensions(num_dims)
        dtype = jnp.result_type(float if dtype is None else dtype)
        n = self.num_particles or default_population(num_dims)
        random = Random(key, self.random)
        mean = random.uniform("mean", (num_dims,), dtype)
        spread = jnp.full((num_dims,), self.sigma, dtype)
        sample = mean[None] + spread[None] * random.normal("sample", (n, num_dims), dtype)
        position = inside(sample)
        best = position[0], jnp.asarray(jnp.inf, dtype)
        return SNESState(position, sample, mean, spread, *best, jnp.zeros((), jnp.int32))

    def update(self, key: jax.Array, state: SNESState, value: jax.Array):
        """Rank, follow the natural gradient, draw."""
        (n, d), dtype = state.position.shape, state.position.dtype
        value = comparable(value, state.position)
        best = best_of(state.position, value, state.best_position, state.best_value)
        best_position, best_value, improved = best

        sample = evaluated(state.sample, state.position)
        z = (sample[ranks(sample, value, state.spread)] - state.mean[None]) / state.spread[None]
        utility = jnp.asarray(utilities(n), dtype)
        mean = state.mean + state.spread * (utility @ z)
        rate = (3.0 + math.log(d)) / (5.0 * math.sqrt(d))
        grow = 0.5 * rate * (utility @ (z**2 - 1.0))
        spread = state.spread * jnp.exp(jnp.clip(grow, -1.0, 1.0))
        spread = jnp.clip(spread, jnp.finfo(dtype).eps, LARGEST).astype(dtype)

        z = Random(key, self.random).normal("sample", (n, d), dtype)
        sample = mean[None] + spread[None] * z
        hyper = {"sigma": spread.max()}
        info = candidate_info(state.position, value, best_value, improved, hyper)
        new = SNESState(
            position=inside(sample),
            sample=sample,
            mean=mean,
            spread=spread,
            best_position=best_position,
            best_value=best_value,
            count=state.count + 1,
        )
        return new, info


def utilities(n: int) -> np.ndarray:
    """Return u (n,), the best first; they sum to zero.

    >>> utilities(4).round(3).tolist()
    [0.48, 0.02, -0.25, -0.25]
    """
    raw = np.maximum(0.0, np.log(n / 2.0 + 1.0) - np.log(np.arange(1, n + 1)))
    return raw / raw.sum() - 1.0 / n


def snes(num_particles: int | None = None, *, sigma: float = 0.3, random: str = "hash") -> SNES:
    """Separable natural evolution strategy with the publication's rates.

    Args:
      num_particles: n, at least 4; default 4 + floor(3 ln d), known when the search begins.
      sigma: first standard deviation in units of the cube.
      random: ``"hash"`` or ``"threefry"``.

    >>> snes().init(jax.random.key(0), 1000).spread.shape
    (1000,)
    """
    if num_particles is not None:
        num_particles = at_least("num_particles", num_particles, 4, "ranks need a better half")
    return SNES(coefficient("sigma", sigma, lower=1e-12), num_particles, check_source(random))
