r"""CMA-ES: a normal distribution that learns the shape of the objective.

Candidates x = m + sigma B D z, z ~ N(0, I), with C = B D^2 B^T. After ranking, the mean moves to
the weighted mean of the best half, two evolution paths accumulate the moves, and

    C      <- (1 - c_1 - c_mu sum_i w_i) C + c_1 p_c p_c^T + c_mu sum_i w_i y_i y_i^T
    sigma  <- sigma exp((c_sigma / d_sigma) (|p_sigma| / E|N(0, I)| - 1)),    y_i = (x_i - m) / sigma

The worse half has negative weights (active CMA), with y_i scaled to the length sqrt(d) so that C
stays positive definite; without them an ill-conditioned ellipsoid took far more evaluations. The
weights, rates and damping are the tutorial's defaults. The distribution lives in all of
R^d and its samples are folded into the unit cube like light between mirrors, so that no walls are
seen; an eigendecomposition is made only as often as C changes noticeably.

Long after a search has converged, or where values do not depend on the candidates, sigma and C drift.
Then the samples keep apart by the rounding of the cube at least, C is brought back to eigenvalues
that a decomposition can tell apart, and its size is moved into sigma, which changes no sample.

Reference:
    N. Hansen, "The CMA evolution strategy: a tutorial", 2016, arXiv 1604.00772.
"""

import math
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.swarm.optimizers.base import at_least, best_of, candidate_info, comparable
from jaxswarm.swarm.pytree import pytree, static
from jaxswarm.swarm.random import Random, check_source
from jaxswarm.swarm.schedules import coefficient

__all__ = ["CMAES", "CMAESState", "cma_es"]

LARGEST = 1e4
"""Standard deviation along the longest axis: far outside what a search in the unit cube can use."""
UNSCALED = 1e8
"""Largest eigenvalue of C, or its inverse, up to which sigma and C are left as they are."""


class CMAESState(NamedTuple):
    """Candidates (n, d), and the distribution that made them.

    Attributes:
      position: (n, d) samples folded into the cube; sample: (n, d) as drawn.
      mean: (d,), sigma: (), covariance: (d, d).
      basis: (d, d) eigenvectors, spread: (d,) square roots of the eigenvalues.
      path_sigma, path_covariance: (d,) evolution paths.
    """

    position: jax.Array
    sample: jax.Array
    mean: jax.Array
    sigma: jax.Array
    covariance: jax.Array
    basis: jax.Array
    spread: jax.Array
    path_sigma: jax.Array
    path_covariance: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    count: jax.Array


class Rates(NamedTuple):
    """Strategy parameters of the tutorial for n candidates in d dimensions (its table 1)."""

    weights: np.ndarray
    mass: float
    c_sigma: float
    d_sigma: float
    c_c: float
    c_1: float
    c_mu: float
    length: float
    gap: int

    @classmethod
    def of(cls, n: int, d: int) -> "Rates":
        """Weights of all candidates, the best first: those of the better half sum to one."""
        mu = n // 2
        raw = np.log((n + 1) / 2) - np.log(np.arange(1, n + 1))
        better, worse = raw[:mu], raw[mu:]
        mass = float(better.sum() ** 2 / np.sum(better**2))  # numpy scalars would promote float32
        c_sigma = (mass + 2.0) / (d + mass + 5.0)
        d_sigma = 1.0 + 2.0 * max(0.0, math.sqrt((mass - 1.0) / (d + 1.0)) - 1.0) + c_sigma
        c_c = (4.0 + mass / d) / (d + 4.0 + 2.0 * mass / d)
        c_1 = 2.0 / ((d + 1.3) ** 2 + mass)
        c_mu = min(1.0 - c_1, 2.0 * (mass - 2.0 + 1.0 / mass) / ((d + 2.0) ** 2 + mass))
        length = math.sqrt(d) * (1.0 - 1.0 / (4.0 * d) + 1.0 / (21.0 * d**2))
        gap = max(1, math.floor(1.0 / (10.0 * d * (c_1 + c_mu))))

        worse_mass = worse.sum() ** 2 / np.sum(worse**2)
        positive_definite = (1.0 - c_1 - c_mu) / (d * c_mu)
        scale = min(1.0 + c_1 / c_mu, 1.0 + 2.0 * worse_mass / (mass + 2.0), positive_definite)
        weights = np.concatenate([better / better.sum(), scale * worse / -worse.sum()])
        return cls(weights, mass, c_sigma, d_sigma, c_c, c_1, c_mu, length, gap)


@pytree
class CMAES:
    """See :func:`cma_es`."""

    sigma: Any
    num_particles: int | None = static()
    random: str = static()

    def init(self, key: jax.Array, num_dims: int, dtype: Any = None) -> CMAESState:
        """Round distribution around a uniform point."""
        dtype = jnp.result_type(float if dtype is None else dtype)
        n = self.num_particles or 4 + math.floor(3.0 * math.log(num_dims))
        random = Random(key, self.random)
        mean = random.uniform("mean", (num_dims,), dtype)
        sigma = jnp.asarray(self.sigma, dtype)
        eye, zero = jnp.eye(num_dims, dtype=dtype), jnp.zeros((num_dims,), dtype)
        sample = mean + sigma * random.normal("sample", (n, num_dims), dtype)
        position = fold_mirrors(sample)
        return CMAESState(
            position=position,
            sample=sample,
            mean=mean,
            sigma=sigma,
            covariance=eye,
            basis=eye,
            spread=jnp.ones((num_dims,), dtype),
            path_sigma=zero,
            path_covariance=zero,
            best_position=position[0],
            best_value=jnp.asarray(jnp.inf, dtype),
            count=jnp.zeros((), jnp.int32),
        )

    def update(self, key: jax.Array, state: CMAESState, value: jax.Array):
        """Rank, move the mean, adapt the shape and the size, draw."""
        (n, d), dtype = state.position.shape, state.position.dtype
        rates = Rates.of(n, d)
        value = comparable(value, dtype)
        best = best_of(state.position, value, state.best_position, state.best_value)
        best_position, best_value, improved = best

        # A wrapper may have put another candidate in a row: then that is what was evaluated.
        same = state.position == fold_mirrors(state.sample)
        sample = jnp.where(same, state.sample, state.position)
        weights = jnp.asarray(rates.weights, dtype)
        y = (sample[jnp.argsort(value)] - state.mean) / state.sigma
        move = weights[: n // 2] @ y[: n // 2]
        mean, sigma = state.mean + state.sigma * move, state.sigma

        whitened = state.basis @ ((state.basis.T @ move) / state.spread)
        keep = math.sqrt(rates.c_sigma * (2.0 - rates.c_sigma) * rates.mass)
        path_sigma = (1.0 - rates.c_sigma) * state.path_sigma + keep * whitened
        norm = jnp.linalg.norm(path_sigma)
        updates = state.count.astype(dtype) + 1.0
        settled = jnp.sqrt(1.0 - (1.0 - rates.c_sigma) ** (2.0 * updates))
        steady = norm / settled < (1.4 + 2.0 / (d + 1.0)) * rates.length
        keep = math.sqrt(rates.c_c * (2.0 - rates.c_c) * rates.mass)
        path = (1.0 - rates.c_c) * state.path_covariance + jnp.where(steady, keep, 0.0) * move

        lengths = jnp.sum((y @ state.basis / state.spread) ** 2, axis=1)
        eps = jnp.finfo(dtype).eps
        # Samples that are all alike have no length: nothing to take away from C.
        scale = jnp.where(weights < 0.0, d / jnp.maximum(lengths, eps), 1.0)
        lost = jnp.where(steady, 0.0, rates.c_1 * rates.c_c * (2.0 - rates.c_c))
        covariance = (
            (1.0 - rates.c_1 - rates.c_mu * float(rates.weights.sum()) + lost) * state.covariance
            + rates.c_1 * jnp.outer(path, path)
            + rates.c_mu * (weights * scale * y.T) @ y
        )
        grow = (rates.c_sigma / rates.d_sigma) * (norm / rates.length - 1.0)
        sigma = sigma * jnp.exp(jnp.minimum(grow, 1.0))
        basis, spread, covariance, size = jax.lax.cond(
            state.count % rates.gap == 0,
            _eigen,
            lambda c: (state.basis, state.spread, c, jnp.ones((), dtype)),
            covariance.astype(dtype),
        )
        path = path / size
        sigma = jnp.clip(sigma * size, eps / spread.max(), LARGEST / spread.max())

        z = Random(key, self.random).normal("sample", (n, d), dtype)
        sample = mean + sigma * (z * spread) @ basis.T
        info = candidate_info(state.position, value, best_value, improved, {"sigma": sigma})
        new = CMAESState(
            position=fold_mirrors(sample),
            sample=sample,
            mean=mean,
            sigma=sigma.astype(dtype),
            covariance=covariance.astype(dtype),
            basis=basis,
            spread=spread,
            path_sigma=path_sigma.astype(dtype),
            path_covariance=path.astype(dtype),
            best_position=best_position,
            best_value=best_value,
            count=state.count + 1,
        )
        return new, info


def fold_mirrors(x: jax.Array) -> jax.Array:
    """Fold R^d into the unit cube: period 2, mirrored at 0 and 1."""
    phase = x - 2.0 * jnp.floor(0.5 * x)
    return jnp.clip(jnp.where(phase > 1.0, 2.0 - phase, phase), 0.0, 1.0)


def _eigen(covariance):
    """Axes, their lengths, C over the square of its size where that is extreme, and the size."""
    covariance = 0.5 * (covariance + covariance.T)
    eigenvalues, basis = jnp.linalg.eigh(covariance)
    largest = eigenvalues[-1]
    extreme = (largest > UNSCALED) | (largest < 1.0 / UNSCALED)
    unit = jnp.where(extreme, largest, 1.0)
    covariance, eigenvalues = covariance / unit, eigenvalues / unit
    # Rounding may push small eigenvalues below zero: bound the condition number instead, in C too,
    # or what was lifted once sinks on.
    floor = jnp.finfo(covariance.dtype).eps * eigenvalues[-1]
    lifted = jnp.maximum(eigenvalues, floor)
    covariance = jnp.where(eigenvalues[0] < floor, (basis * lifted) @ basis.T, covariance)
    return basis, jnp.sqrt(lifted), covariance, jnp.sqrt(unit)


def cma_es(num_particles: int | None = None, *, sigma: float = 0.3, random: str = "hash") -> CMAES:
    """Covariance matrix adaptation with the tutorial's default strategy parameters.

    Args:
      num_particles: n, at least 4; default 4 + floor(3 ln d), known when the search begins.
      sigma: first step size in units of the cube.
      random: ``"hash"`` or ``"threefry"``.

    >>> cma_es().init(jax.random.key(0), 13).position.shape
    (11, 13)
    """
    if num_particles is not None:
        num_particles = at_least("num_particles", num_particles, 4, "half of them are parents")
    return CMAES(coefficient("sigma", sigma, lower=1e-12), num_particles, check_source(random))
