r"""Separable CMA-ES: a standard deviation for every coordinate, in linear time and memory.

As CMA-ES with C = diag(c). Since only d numbers are learned, c_1 and c_mu are (d + 2) / 3 times
theirs:

    c      <- (1 - c_1 - c_mu) c + c_1 p_c^2 + c_mu sum_i w_i y_i^2,      x_i = m + sigma y_i
    sigma  <- sigma exp((c_sigma / d_sigma) (|p_sigma| / E|N(0, I)| - 1))

with positive weights of the better half. Good where coordinates hardly depend on one another, and
from some hundred dimensions on. Walls as for ``cma_es``.

Reference:
    R. Ros, N. Hansen, "A simple modification in CMA-ES achieving linear time and space complexity",
    PPSN X, 2008, doi 10.1007/978-3-540-87700-4_30.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.swarm.optimizers.base import at_least, best_of, candidate_info, comparable, dimensions
from jaxswarm.swarm.optimizers.cma_distribution import LARGEST, Rates
from jaxswarm.swarm.optimizers.cma_es import default_population
from jaxswarm.swarm.optimizers.outside import evaluated, inside, ranks
from jaxswarm.swarm.pytree import pytree, static
from jaxswarm.swarm.random import Random, check_source
from jaxswarm.swarm.schedules import coefficient

__all__ = ["SepCMAES", "SepCMAESState", "sep_cma_es"]


class SepCMAESState(NamedTuple):
    """Candidates (n, d), the samples (n, d) as drawn, and the distribution.

    Attributes:
      mean, variance: (d,), m and c; sigma: ().
      path_sigma, path_covariance: (d,) evolution paths.
    """

    position: jax.Array
    sample: jax.Array
    mean: jax.Array
    variance: jax.Array
    sigma: jax.Array
    path_sigma: jax.Array
    path_covariance: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


@pytree
class SepCMAES:
    """See :func:`sep_cma_es`."""

    sigma: Any
    num_particles: int | None = static()
    random: str = static()

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> SepCMAESState:
        """Round distribution around a uniform point."""
        num_dims = dimensions(num_dims)
        dtype = jnp.result_type(float if dtype is None else dtype)
        n = self.num_particles or default_population(num_dims)
        random = Random(key, self.random)
        mean = random.uniform("mean", (num_dims,), dtype)
        sigma, zero = jnp.asarray(self.sigma, dtype), jnp.zeros((num_dims,), dtype)
        sample = mean[None] + sigma * random.normal("sample", (n, num_dims), dtype)
        position = inside(sample)
        best = position[0], jnp.asarray(jnp.inf, dtype)
        shape = mean, zero + 1.0, sigma, zero, zero
        return SepCMAESState(position, sample, *shape, *best, jnp.zeros((), jnp.int32))

    def update(self, key: jax.Array, state: SepCMAESState, value: jax.Array):
        """Rank, move the mean, adapt the standard deviations, draw."""
        (n, d), dtype = state.position.shape, state.position.dtype
        value = comparable(value, state.position)
        best = best_of(state.position, value, state.best_position, state.best_value)
        best_position, best_value, improved = best
        rates = Rates.of(n, d)
        c_1 = min(1.0, rates.c_1 * (d + 2.0) / 3.0)
        c_mu = min(1.0 - c_1, rates.c_mu * (d + 2.0) / 3.0)
        weights = jnp.asarray(rates.weights[: n // 2], dtype)

        sample = evaluated(state.sample, state.position)
        spread = state.sigma * jnp.sqrt(state.variance)
        y = (sample[ranks(sample, value, spread)[: n // 2]] - state.mean[None]) / state.sigma
        move = weights @ y
        keep = (rates.c_sigma * (2.0 - rates.c_sigma) * rates.mass) ** 0.5
        whitened = move / jnp.sqrt(state.variance)
        path_sigma = (1.0 - rates.c_sigma) * state.path_sigma + keep * whitened
        norm = jnp.linalg.norm(path_sigma)
        settled = jnp.sqrt(1.0 - (1.0 - rates.c_sigma) ** (2.0 * (state.count.astype(dtype) + 1.0)))
        steady = norm / settled < (1.4 + 2.0 / (d + 1.0)) * rates.length
        keep = (rates.c_c * (2.0 - rates.c_c) * rates.mass) ** 0.5
        path = (1.0 - rates.c_c) * state.path_covariance + jnp.where(steady, keep, 0.0) * move

        variance = (1.0 - c_1 - c_mu) * state.variance + c_1 * path**2 + c_mu * (weights @ y**2)
        grow = (rates.c_sigma / rates.d_sigma) * (norm / rates.length - 1.0)
        # The size of c is moved into sigma, which changes no sample: neither can leave its range.
        size = jnp.sqrt(variance.max())
        eps = jnp.finfo(dtype).eps
        sigma = state.sigma * jnp.exp(jnp.minimum(grow, 1.0)) * size
        sigma = jnp.clip(sigma, eps, LARGEST).astype(dtype)
        variance = jnp.maximum(variance / size**2, eps)

        mean = state.mean + state.sigma * move
        z = Random(key, self.random).normal("sample", (n, d), dtype)
        sample = mean[None] + (sigma * jnp.sqrt(variance))[None] * z
        info = candidate_info(state.position, value, best_value, improved, {"sigma": sigma})
        new = SepCMAESState(
            position=inside(sample),
            sample=sample,
            mean=mean,
            variance=variance,
            sigma=sigma,
            path_sigma=path_sigma,
            path_covariance=path / size,
            best_position=best_position,
            best_value=best_value,
            count=state.count + 1,
        )
        return new, info


def sep_cma_es(
    num_particles: int | None = None, *, sigma: float = 0.3, random: str = "hash"
) -> SepCMAES:
    """CMA-ES that learns a standard deviation for every coordinate and no correlations.

    Args:
      num_particles: n, at least 4; default 4 + floor(3 ln d), known when the search begins.
      sigma: first step size in units of the cube.
      random: ``"hash"`` or ``"threefry"``.

    >>> sep_cma_es().init(jax.random.key(0), 1000).position.shape
    (24, 1000)
    """
    if num_particles is not None:
        num_particles = at_least("num_particles", num_particles, 4, "half of them are parents")
    return SepCMAES(coefficient("sigma", sigma, lower=1e-12), num_particles, check_source(random))
