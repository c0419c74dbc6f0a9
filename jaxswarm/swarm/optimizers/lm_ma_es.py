r"""LM-MA-ES: correlations of hundreds of dimensions from a handful of remembered directions.

The matrix that CMA-ES learns is replaced by the product of k = 4 + floor(3 ln d) rank-one factors,

    d_i  = z_i;   d_i <- (1 - a_j) d_i + a_j m_j (m_j . d_i)  for j = 1 ... k,     x_i = m + sigma d_i
    m   <- m + sigma sum_i w_i d_i
    p   <- (1 - c_sigma) p + sqrt(mu_w c_sigma (2 - c_sigma)) sum_i w_i z_i
    m_j <- (1 - b_j) m_j + sqrt(mu_w b_j (2 - b_j)) sum_i w_i z_i
    sigma <- sigma exp(c_sigma / 2 (|p|^2 / d - 1))

with a_j = 1 / (1.5^(j-1) d), b_j = n / (4^(j-1) d), c_sigma = 2 n / d, the weights of the better half
as in CMA-ES, and one factor more in use every generation until all are. A candidate costs O(d k).

Deviations: b_j and c_sigma are at most 1 (the rule is meant for d far above n; in a few dimensions it may
settle early), and sigma stays where all values are alike; a candidate that a wrapper put in has no z, its
d is taken for it. Walls as for ``cma_es``.

Reference:
    I. Loshchilov, T. Glasmachers, H.-G. Beyer, "Large scale black-box optimization by limited-memory
    matrix adaptation", IEEE Trans. Evol. Comput. 23 (2019), doi 10.1109/TEVC.2018.2855049.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.swarm.optimizers.base import at_least, best_of, candidate_info, comparable, dimensions
from jaxswarm.swarm.optimizers.cma_distribution import LARGEST, Rates
from jaxswarm.swarm.optimizers.cma_es import default_population
from jaxswarm.swarm.optimizers.outside import inside, ranks
from jaxswarm.swarm.pytree import pytree, static
from jaxswarm.swarm.random import Random, check_source
from jaxswarm.swarm.schedules import coefficient

__all__ = ["LMMAES", "LMMAESState", "lm_ma_es"]


class LMMAESState(NamedTuple):
    """Candidates (n, d) and what made them.

    Attributes:
      noise: (n, d) z; sample: (n, d) as drawn.
      mean: (d,); sigma: (); path: (d,) p; directions: (k, d) m_j.
    """

    position: jax.Array
    noise: jax.Array
    sample: jax.Array
    mean: jax.Array
    sigma: jax.Array
    path: jax.Array
    directions: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


@pytree
class LMMAES:
    """See :func:`lm_ma_es`."""

    sigma: Any
    num_particles: int | None = static()
    num_directions: int | None = static()
    random: str = static()

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> LMMAESState:
        """Round distribution around a uniform point."""
        num_dims = dimensions(num_dims)
        dtype = jnp.result_type(float if dtype is None else dtype)
        n = self.num_particles or default_population(num_dims)
        random = Random(key, self.random)
        mean = random.uniform("mean", (num_dims,), dtype)
        sigma = jnp.asarray(self.sigma, dtype)
        noise = random.normal("sample", (n, num_dims), dtype)
        sample = mean[None] + sigma * noise
        position = inside(sample)
        return LMMAESState(
            position=position,
            noise=noise,
            sample=sample,
            mean=mean,
            sigma=sigma,
            path=jnp.zeros((num_dims,), dtype),
            directions=jnp.zeros(
                (self.num_directions or default_population(num_dims), num_dims), dtype
            ),
            best_position=position[0],
            best_value=jnp.asarray(jnp.inf, dtype),
            count=jnp.zeros((), jnp.int32),
        )

    def update(self, key: jax.Array, state: LMMAESState, value: jax.Array):
        """Rank, move the mean, turn the directions, draw."""
        (n, d), dtype = state.position.shape, state.position.dtype
        value = comparable(value, state.position)
        best = best_of(state.position, value, state.best_position, state.best_value)
        best_position, best_value, improved = best
        rates = Rates.of(n, d)
        weights = jnp.asarray(rates.weights[: n // 2], dtype)

        drawn = state.position == inside(state.sample)
        sample = jnp.where(drawn, state.sample, state.position)
        better = ranks(sample, value, state.sigma)[: n // 2]
        step = (sample - state.mean[None]) / state.sigma
        noise = jnp.where(drawn.all(axis=1, keepdims=True), state.noise, step)
        move, noise = weights @ step[better], weights @ noise[better]
        c_sigma = min(1.0, 2.0 * n / d)
        path = _blend(state.path, noise, c_sigma, rates.mass)
        grow = 0.5 * c_sigma * (jnp.sum(path**2) / d - 1.0)
        # Values all alike, infinite ones too, rank nothing: a size that then drifts may be lost for good.
        grow = jnp.where(value.min() < value.max(), jnp.minimum(grow, 1.0), 0.0)
        sigma = state.sigma * jnp.exp(grow)
        sigma = jnp.clip(sigma, jnp.finfo(dtype).eps, LARGEST).astype(dtype)
        number = np.arange(state.directions.shape[0])
        turn = np.minimum(1.0, n / (4.0**number * d))[:, None]
        directions = _blend(state.directions, noise[None], jnp.asarray(turn, dtype), rates.mass)

        mean = state.mean + state.sigma * move
        z = Random(key, self.random).normal("sample", (n, d), dtype)
        sample = mean[None] + sigma * _turned(z, directions, state.count + 1)
        info = candidate_info(state.position, value, best_value, improved, {"sigma": sigma})
        new = LMMAESState(
            position=inside(sample),
            noise=z,
            sample=sample,
            mean=mean,
            sigma=sigma,
            path=path,
            directions=directions,
            best_position=best_position,
            best_value=best_value,
            count=state.count + 1,
        )
        return new, info


def _blend(old, new, rate, mass):
    """Fade the old and add so much of the new that a normal distribution stays as wide as it is."""
    return (1.0 - rate) * old + (rate * (2.0 - rate) * mass) ** 0.5 * new


def _turned(z, directions, in_use):
    """Apply the factors in use to the rows of z."""
    d = z.shape[1]

    def apply(rows, factor):
        number, direction = factor
        share = jnp.where(number < in_use, 1.0 / (1.5 ** number.astype(z.dtype) * d), 0.0)
        share = share.astype(z.dtype)
        return (1.0 - share) * rows + share * jnp.outer(rows @ direction, direction), None

    numbers = jnp.arange(directions.shape[0], dtype=jnp.int32)
    return jax.lax.scan(apply, z, (numbers, directions))[0]


def lm_ma_es(
    num_particles: int | None = None,
    *,
    sigma: float = 0.3,
    num_directions: int | None = None,
    random: str = "hash",
) -> LMMAES:
    """Limited-memory matrix adaptation for hundreds of dimensions and more.

    Args:
      num_particles: n, at least 4; default 4 + floor(3 ln d), known when the search begins.
      sigma: first step size in units of the cube.
      num_directions: k, rank-one factors remembered; default 4 + floor(3 ln d).
      random: ``"hash"`` or ``"threefry"``.

    >>> lm_ma_es().init(jax.random.key(0), 1000).directions.shape
    (24, 1000)
    """
    if num_particles is not None:
        num_particles = at_least("num_particles", num_particles, 4, "half of them are parents")
    if num_directions is not None:
        num_directions = at_least("num_directions", num_directions, 1, "it is what is learned")
    first = coefficient("sigma", sigma, lower=1e-12)
    return LMMAES(first, num_particles, num_directions, check_source(random))
