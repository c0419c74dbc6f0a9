r"""The normal distribution of CMA-ES: how it is sampled and how a ranked generation changes it.

Candidates x = m + sigma B D B^T z, z ~ N(0, I), with C = B D^2 B^T. After ranking, the mean moves to
the weighted mean of the best half, two evolution paths accumulate the moves, and

    C      <- (1 - c_1 - c_mu sum_i w_i) C + c_1 p_c p_c^T + c_mu sum_i w_i y_i y_i^T
    sigma  <- sigma exp((c_sigma / d_sigma) (|p_sigma| / E|N(0, I)| - 1)),    y_i = (x_i - m) / sigma

The worse half has negative weights (active CMA), with y_i scaled to the length sqrt(d) so that C
stays positive definite; without them an ill-conditioned ellipsoid took far more evaluations. The
weights and rates are the tutorial's defaults, and so is the damping

    d_sigma = 1 + c_sigma + 2 max(0, r sqrt((mu_eff - 1) / (d + 1)) - 1),    r = max(1, 3 (1 - 2^(-d / 9)))

but for r, 1 up to five dimensions, which pycma has had since its version 4: with the tutorial's r = 1 the
step of a large population in 20 dimensions falls sooner than it has found its way over the steps of
BBOB's f7. The distribution lives in all of R^d, walls are seen by
:mod:`~jaxswarm.swarm.optimizers.outside` alone; an eigendecomposition is made only as often as C changes
noticeably.

B D z has the same distribution, but in many dimensions most eigenvalues of C are equal at first, and which
axes a decomposition gives them is decided by rounding: with the same key a search beside others, or on another
machine, was another search after one step. The root B D B^T is the same whatever they are.

Long after a search has converged, or where values do not depend on the candidates, sigma and C drift.
Then the samples keep apart by the rounding of the cube at least, C is brought back to eigenvalues
that a decomposition can tell apart, and its size is moved into sigma, which changes no sample.

Reference:
    N. Hansen, "The CMA evolution strategy: a tutorial", 2016, arXiv 1604.00772.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.swarm.optimizers.products import over_columns, over_rows
from jaxswarm.swarm.random import Random

__all__ = ["LARGEST", "Distribution", "Rates", "adapt", "deviations", "draw", "round_at"]

LARGEST = 1e4
"""Standard deviation along the longest axis: far outside what a search in the unit cube can use."""
UNSCALED = 1e8
"""Largest eigenvalue of C, or its inverse, up to which sigma and C are left as they are."""

SLOWER, HALF_AS_SLOW = 3.0, 9.0
"""How much more a large population damps its step in many dimensions, and in how many half as much."""


class Distribution(NamedTuple):
    """Mean (d,), sigma (), covariance and basis (d, d), square roots of the eigenvalues (d,), paths.

    Attributes:
      basis: eigenvectors in columns; spread: standard deviation over sigma along each of them, rising.
      path_sigma, path_covariance: (d,) evolution paths.
      generation: () int32, generations since the distribution was round.
    """

    mean: jax.Array
    sigma: jax.Array
    covariance: jax.Array
    basis: jax.Array
    spread: jax.Array
    path_sigma: jax.Array
    path_covariance: jax.Array
    generation: jax.Array


class Rates(NamedTuple):
    """Strategy parameters of the tutorial for n candidates in d dimensions (its table 1)."""

    weights: Any
    mass: Any
    c_sigma: Any
    d_sigma: Any
    c_c: Any
    c_1: Any
    c_mu: Any
    length: float
    gap: Any

    @classmethod
    def of(cls, n: int, d: int) -> "Rates":
        """Weights of all candidates, the best first: those of the better half sum to one."""
        rates = cls._of(np, n, d, np.arange(n, dtype=float))
        # Python numbers: those of NumPy would promote float32.
        plain: dict[str, Any] = {name: float(getattr(rates, name)) for name in cls._fields[1:-1]}
        return rates._replace(gap=int(rates.gap), **plain)

    @classmethod
    def among(cls, rows: int, n: jax.Array, d: int, dtype: Any) -> "Rates":
        """The same for a number n of candidates that may be traced; weights (rows,), 0 from n on."""
        return cls._of(jnp, n.astype(dtype), d, jnp.arange(rows, dtype=dtype))

    @classmethod
    def _of(cls, xp, n, d, rank):
        raw = xp.log((n + 1.0) / 2.0) - xp.log(rank + 1.0)
        better = xp.where(rank < n // 2, raw, 0.0)
        worse = xp.where((rank >= n // 2) & (rank < n), raw, 0.0)
        mass = better.sum() ** 2 / xp.sum(better**2)
        c_sigma = (mass + 2.0) / (d + mass + 5.0)
        slow = max(1.0, SLOWER * (1.0 - 0.5 ** (d / HALF_AS_SLOW)))
        wide = slow * xp.sqrt(xp.maximum((mass - 1.0) / (d + 1.0), 0.0)) - 1.0
        d_sigma = 1.0 + 2.0 * xp.maximum(0.0, wide) + c_sigma
        c_c = (4.0 + mass / d) / (d + 4.0 + 2.0 * mass / d)
        c_1 = 2.0 / ((d + 1.3) ** 2 + mass)
        c_mu = 2.0 * (mass - 1.75 + 1.0 / mass) / ((d + 2.0) ** 2 + mass)
        c_mu = xp.minimum(1.0 - c_1, c_mu)
        length = d**0.5 * (1.0 - 1.0 / (4.0 * d) + 1.0 / (21.0 * d**2))
        gap = xp.maximum(1.0, xp.floor(1.0 / (10.0 * d * (c_1 + c_mu))))

        worse_mass = worse.sum() ** 2 / xp.sum(worse**2)
        positive_definite = (1.0 - c_1 - c_mu) / (d * c_mu)
        scale = xp.minimum(1.0 + c_1 / c_mu, 1.0 + 2.0 * worse_mass / (mass + 2.0))
        scale = xp.minimum(scale, positive_definite)
        weights = better / better.sum() + scale * worse / -worse.sum()
        return cls(weights, mass, c_sigma, d_sigma, c_c, c_1, c_mu, length, gap.astype(int))


def round_at(mean: jax.Array, sigma: Any) -> Distribution:
    """The distribution at the start of a search: C = I."""
    d, dtype = mean.size, mean.dtype
    zero = jnp.zeros((d,), dtype)
    eye, one = jnp.asarray(np.eye(d), dtype), jnp.ones((d,), dtype)
    sigma = jnp.asarray(sigma, dtype)
    return Distribution(mean, sigma, eye, eye, one, zero, zero, jnp.zeros((), jnp.int32))


def draw(random: Random, of: Distribution, n: int) -> jax.Array:
    """Draw n samples (n, d) in all of R^d; what is evaluated is ``inside`` of them."""
    d = of.mean.size
    # In one row, scaled by the product: a CPU takes four times as long for many short rows (``repeating``).
    z = random.normal("sample", (n * d,), of.mean.dtype).reshape(n, d)
    axes = of.basis * of.spread[None]
    # The same product of three, from the side on which it is smaller.
    few = n < d
    y = over_columns(z @ axes, of.basis) if few else z @ over_columns(axes, of.basis)
    return of.mean[None] + of.sigma * y


def deviations(of: Distribution) -> jax.Array:
    """Return the standard deviations (d,) of the coordinates."""
    # By a mask: an index for every coordinate takes longer to trace, to compile and in many runs.
    on_diagonal = np.eye(of.mean.size, dtype=bool)
    return of.sigma * jnp.sqrt(jnp.sum(jnp.where(on_diagonal, of.covariance, 0.0), axis=0))


def adapt(old: Distribution, sample: jax.Array, rates: Rates, place: Any = None) -> Distribution:
    """Move the mean, adapt the shape and the size.

    Args:
      old: what the samples were drawn from.
      sample: (n, d), the best first; rows of weight 0 do not count.
      rates: for as many candidates as count.
      place: (n,) int32, where each row comes if the best is not first.
    """
    d, dtype = old.mean.size, old.mean.dtype
    eps = jnp.finfo(dtype).eps
    weights, total = (jnp.asarray(a, dtype) for a in (rates.weights, rates.weights.sum()))
    weights = weights if place is None else weights[place]
    y = (sample - old.mean[None]) / old.sigma
    move = jnp.maximum(weights, 0.0) @ y
    mean = old.mean + old.sigma * move

    whitened = old.basis @ ((old.basis.T @ move) / old.spread)
    keep = (rates.c_sigma * (2.0 - rates.c_sigma) * rates.mass) ** 0.5
    path_sigma = (1.0 - rates.c_sigma) * old.path_sigma + keep * whitened
    norm = jnp.sqrt(jnp.sum(path_sigma**2))
    updates = old.generation.astype(dtype) + 1.0
    settled = jnp.sqrt(1.0 - (1.0 - rates.c_sigma) ** (2.0 * updates))
    steady = norm / settled < (1.4 + 2.0 / (d + 1.0)) * rates.length
    keep = (rates.c_c * (2.0 - rates.c_c) * rates.mass) ** 0.5
    path = (1.0 - rates.c_c) * old.path_covariance + jnp.where(steady, keep, 0.0) * move

    lengths = jnp.sum((y @ old.basis / old.spread[None]) ** 2, axis=1)
    # Samples that are all alike have no length: nothing to take away from C.
    scale = jnp.where(weights < 0.0, d / jnp.maximum(lengths, eps), 1.0)
    lost = jnp.where(steady, 0.0, rates.c_1 * rates.c_c * (2.0 - rates.c_c))
    covariance = (
        (1.0 - rates.c_1 - rates.c_mu * total + lost) * old.covariance
        + rates.c_1 * jnp.outer(path, path)
        + rates.c_mu * over_rows((weights * scale)[:, None] * y, y)
    )
    grow = (rates.c_sigma / rates.d_sigma) * (norm / rates.length - 1.0)
    sigma = old.sigma * jnp.exp(jnp.minimum(grow, 1.0))
    basis, spread, covariance, size = jax.lax.cond(
        jax.lax.rem(old.generation, jnp.asarray(rates.gap, jnp.int32)) == 0,
        _eigen,
        lambda c: (old.basis, old.spread, c, jnp.ones((), dtype)),
        covariance.astype(dtype),
    )
    sigma = jnp.clip(sigma * size, eps / spread[-1], LARGEST / spread[-1])
    count = old.generation + 1
    new = Distribution(mean, sigma, covariance, basis, spread, path_sigma, path / size, count)
    return jax.tree.map(lambda part, before: part.astype(before.dtype), new, old)


def _eigen(covariance):
    """Axes, their lengths, C over the square of its size where that is extreme, and the size."""
    covariance = 0.5 * (covariance + covariance.T)
    basis, eigenvalues = jax.lax.linalg.eigh(covariance, symmetrize_input=False)
    largest = eigenvalues[-1]
    extreme = (largest > UNSCALED) | (largest < 1.0 / UNSCALED)
    unit = jnp.where(extreme, largest, 1.0)
    covariance, eigenvalues = covariance / unit, eigenvalues / unit
    # Rounding may push small eigenvalues below zero: bound the condition number instead, in C too,
    # or what was lifted once sinks on.
    floor = jnp.finfo(covariance.dtype).eps * eigenvalues[-1]
    lifted = jnp.maximum(eigenvalues, floor)
    whole = over_columns(basis * lifted[None], basis)
    covariance = jnp.where(eigenvalues[0] < floor, whole, covariance)
    return basis, jnp.sqrt(lifted), covariance, jnp.sqrt(unit)
