r"""OpenES: a smoothed gradient from mirrored samples, followed by Adam.

With n/2 directions z_i ~ N(0, I), each tried both ways, and centered ranks r in [-1/2, 1/2],

    x_i = m +- sigma z_i,      g = 1 / (n sigma) sum_i r_i (x_i - m) / sigma
    p <- b1 p + (1 - b1) g,    q <- b2 q + (1 - b2) g^2
    m <- m - eta sigma p / (1 - b1^t) / (sqrt(q / (1 - b2^t)) + 1e-8)

elementwise, b1 = 0.9, b2 = 0.999. Meant for many parameters and many candidates side by side. Walls as
for ``cma_es``.

Deviations: the rate eta is in units of sigma, so that one schedule lets both fall; the publication
keeps them constant and scales g, which Adam undoes.

References:
    T. Salimans, J. Ho, X. Chen, S. Sidor, I. Sutskever, "Evolution strategies as a scalable
    alternative to reinforcement learning", 2017, arXiv 1703.03864; D. P. Kingma, J. Ba, "Adam",
    2015, arXiv 1412.6980.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError
from jaxswarm.swarm.optimizers.base import at_least, best_of, candidate_info, comparable, dimensions
from jaxswarm.swarm.optimizers.outside import evaluated, inside, ranks
from jaxswarm.swarm.pytree import pytree, static
from jaxswarm.swarm.random import Random, check_source
from jaxswarm.swarm.schedules import ScalarOrSchedule, coefficient, evaluate, linear

__all__ = ["OpenES", "OpenESState", "open_es"]

FIRST_DECAY, SECOND_DECAY, TINY = 0.9, 0.999, 1e-8
"""Adam's, as published."""


class OpenESState(NamedTuple):
    """Candidates (n, d), the samples (n, d) as drawn, the mean (d,) and Adam's moments (d,).

    ``sigma`` () is the one that the samples were drawn with.
    """

    position: jax.Array
    sample: jax.Array
    sigma: jax.Array
    mean: jax.Array
    first_moment: jax.Array
    second_moment: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


@pytree
class OpenES:
    """See :func:`open_es`."""

    sigma: ScalarOrSchedule
    learning_rate: ScalarOrSchedule
    num_particles: int = static()
    random: str = static()

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> OpenESState:
        """Mirrored samples around a uniform point."""
        num_dims = dimensions(num_dims)
        dtype = jnp.result_type(float if dtype is None else dtype)
        random = Random(key, self.random)
        mean, zero = random.uniform("mean", (num_dims,), dtype), jnp.zeros((), jnp.int32)
        sigma = evaluate("sigma", self.sigma, zero, dtype)
        sample = self._mirrored(random, mean, sigma)
        position = inside(sample)
        still = jnp.zeros_like(mean)
        best = position[0], jnp.asarray(jnp.inf, dtype)
        return OpenESState(position, sample, sigma, mean, still, still, *best, zero)

    def update(self, key: jax.Array, state: OpenESState, value: jax.Array):
        """Rank, take a step of Adam, draw."""
        n, dtype = self.num_particles, state.position.dtype
        value = comparable(value, state.position)
        best = best_of(state.position, value, state.best_position, state.best_value)
        best_position, best_value, improved = best

        sample = evaluated(state.sample, state.position)
        order = ranks(sample, value, state.sigma)
        rank = jnp.zeros((n,), dtype).at[order].set(jnp.arange(n, dtype=dtype))
        step = (sample - state.mean[None]) / state.sigma
        gradient = (rank / (n - 1) - 0.5) @ step / (n * state.sigma)
        first = FIRST_DECAY * state.first_moment + (1.0 - FIRST_DECAY) * gradient
        second = SECOND_DECAY * state.second_moment + (1.0 - SECOND_DECAY) * gradient**2
        updates = state.count.astype(dtype) + 1.0
        moved = first / (1.0 - FIRST_DECAY**updates)
        size = jnp.sqrt(second / (1.0 - SECOND_DECAY**updates)) + TINY
        rate = evaluate("learning_rate", self.learning_rate, state.count, dtype)
        mean = state.mean - rate * state.sigma * moved / size

        sigma = evaluate("sigma", self.sigma, state.count + 1, dtype)
        sample = self._mirrored(Random(key, self.random), mean, sigma)
        hyper = {"sigma": state.sigma, "learning_rate": rate}
        info = candidate_info(state.position, value, best_value, improved, hyper)
        new = OpenESState(
            position=inside(sample),
            sample=sample,
            sigma=sigma,
            mean=mean.astype(dtype),
            first_moment=first.astype(dtype),
            second_moment=second.astype(dtype),
            best_position=best_position,
            best_value=best_value,
            count=state.count + 1,
        )
        return new, info

    def _mirrored(self, random, mean, sigma):
        z = random.normal("sample", (self.num_particles // 2, mean.size), mean.dtype)
        return mean[None] + sigma * jnp.concatenate([z, -z])


def open_es(
    num_particles: int = 64,
    num_steps: float | None = None,
    *,
    sigma: ScalarOrSchedule | None = None,
    learning_rate: ScalarOrSchedule = 0.5,
    random: str = "hash",
) -> OpenES:
    """Evolution strategy with mirrored samples, centered ranks and Adam.

    Args:
      num_particles: n, even, at least 4.
      num_steps: updates over which the default ``sigma`` falls; default as many as ``minimize``
        makes.
      sigma: standard deviation of the samples in units of the cube, above 0; default linearly from
        0.1 to 0.001.
      learning_rate: eta, Adam's rate in units of sigma.
      random: ``"hash"`` or ``"threefry"``.

    >>> open_es(8).init(jax.random.key(0), 3).position.shape
    (8, 3)
    """
    n = at_least("num_particles", num_particles, 4, "directions are tried both ways")
    if n % 2:
        raise InputError(f"num_particles={n} is odd: every direction is tried both ways.")
    falling = linear(0.1, 1e-3, num_steps)
    return OpenES(
        sigma=falling if sigma is None else coefficient("sigma", sigma, lower=1e-12),
        learning_rate=coefficient("learning_rate", learning_rate, lower=0.0),
        num_particles=n,
        random=check_source(random),
    )
