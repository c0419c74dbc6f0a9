"""Genetic operators on the unit cube: selection, crossover, mutation; each a part of ``ga``.

    selection  (random, value (n,))        -> parents (2, n) int: two parents for each pair of
    children crossover  (random, first, second)     -> children (n, d) of parents (m, d) and (m, d),
    2 m >= n mutation   (random, children (n, d))   -> children in [0, 1]

References:
    K. Deb, R. B. Agrawal, "Simulated binary crossover for continuous search space", Complex Systems
    9 (1995); K. Deb, "An efficient constraint handling method for genetic algorithms", Comput.
    Methods Appl. Mech. Eng. 186 (2000), doi 10.1016/S0045-7825(99)00389-8 (bounded forms); D. E.
    Goldberg, "Genetic algorithms in search, optimization and machine learning", 1989 (roulette); A.
    Sokolov, D. Whitley, "Unbiased tournament selection", GECCO 2005.
"""

from typing import Any

import jax.numpy as jnp

from jaxswarm.swarm.optimizers.base import at_least
from jaxswarm.swarm.pytree import pytree, static
from jaxswarm.swarm.schedules import coefficient

__all__ = ["arithmetic", "gaussian", "polynomial", "roulette", "sbx", "tournament", "uniform"]


def tournament(size: int = 2) -> "Tournament":
    """Each parent is the best of ``size`` members; every member enters as many tournaments."""
    return Tournament(at_least("size", size, 1, "somebody must compete"))


def roulette(floor: float = 1e-12) -> "Roulette":
    """Each parent is drawn with probability proportional to 1 / (value + floor), for values >= 0.

    Values below zero are shifted so that the best is zero.
    """
    return Roulette(coefficient("floor", floor, lower=0.0))


def sbx(eta: float = 15.0, rate: float = 0.9) -> "SBX":
    """Simulated binary crossover within the bounds; children lie near parents if ``eta`` is large.

    Args:
      eta: distribution index.
      rate: share of pairs that cross; each of their coordinates crosses with probability 1/2.
    """
    return SBX(coefficient("eta", eta, lower=0.0), coefficient("rate", rate, lower=0.0, upper=1.0))


def arithmetic(rate: float = 0.8) -> "Arithmetic":
    """Children a x + (1 - a) y and a y + (1 - a) x, a uniform in (0, 1), for a share of pairs."""
    return Arithmetic(coefficient("rate", rate, lower=0.0, upper=1.0))


def polynomial(eta: float = 20.0, rate: float | None = None) -> "Polynomial":
    """Polynomial mutation within the bounds; ``rate`` a coordinate, default 1/d."""
    return Polynomial(coefficient("eta", eta, lower=0.0), _rate(rate))


def gaussian(scale: float = 0.1, rate: float | None = None) -> "Gaussian":
    """Add normal noise of standard deviation ``scale``, clipped; ``rate`` default 1/d."""
    return Gaussian(coefficient("scale", scale, lower=0.0), _rate(rate))


def uniform(rate: float | None = 0.1) -> "Uniform":
    """Draw a coordinate anew, uniform in the range, with probability ``rate``."""
    return Uniform(_rate(rate))


@pytree
class Tournament:
    """See :func:`tournament`."""

    size: int = static()

    def __call__(self, random, value):
        # Orders, not free draws: those leave out the best member of a small population now and then.
        n, count = value.shape[0], 2 * self.size
        orders = [random.permutation(f"entrants/{k}", n) for k in range(count)]
        entrants = jnp.stack(orders).reshape(self.size, 2, n)
        winner = jnp.argmin(value[entrants], axis=0)
        return jnp.take_along_axis(entrants, winner[None], axis=0)[0]


@pytree
class Roulette:
    """See :func:`roulette`."""

    floor: Any

    def __call__(self, random, value):
        n = value.shape[0]
        finite = jnp.isfinite(value)
        shift = jnp.minimum(0.0, jnp.where(finite, value, jnp.inf).min())
        weight = 1.0 / (jnp.where(finite, value - shift, jnp.inf) + self.floor)
        weight = jnp.where(finite.any(), weight, jnp.ones_like(weight))
        # Normalize by the largest first: a single value near zero must not overflow the sum.
        wheel = jnp.cumsum(weight / weight.max())
        spin = random.uniform("wheel", (2, n), value.dtype) * wheel[-1]
        return jnp.clip(jnp.searchsorted(wheel, spin.ravel()), 0, n - 1).reshape(2, n)


@pytree
class SBX:
    """See :func:`sbx`."""

    eta: Any
    rate: Any

    def __call__(self, random, first, second):
        shape, dtype = first.shape, first.dtype
        low, high = jnp.minimum(first, second), jnp.maximum(first, second)
        gap = jnp.maximum(high - low, 1e-14)
        u = random.uniform("spread", shape, dtype)
        exponent = 1.0 / (self.eta + 1.0)

        def spread(room):
            alpha = 2.0 - (1.0 + 2.0 * room / gap) ** -(self.eta + 1.0)
            inner = u * alpha
            outer = 1.0 / jnp.maximum(2.0 - inner, 1e-14)
            return jnp.where(inner <= 1.0, inner, outer) ** exponent

        lower = 0.5 * (low + high - spread(low) * gap)
        upper = 0.5 * (low + high + spread(1.0 - high) * gap)
        # Which child gets which side is a coin toss, per coordinate.
        swap = random.uniform("side", shape, dtype) < 0.5
        a, b = jnp.where(swap, upper, lower), jnp.where(swap, lower, upper)
        pairs = random.uniform("pairs", (shape[0], 1), dtype) < self.rate
        crossed = pairs & (random.uniform("crossed", shape, dtype) < 0.5)
        children = jnp.where(crossed, a, first), jnp.where(crossed, b, second)
        return jnp.clip(jnp.concatenate(children), 0.0, 1.0)


@pytree
class Arithmetic:
    """See :func:`arithmetic`."""

    rate: Any

    def __call__(self, random, first, second):
        shape, dtype = (first.shape[0], 1), first.dtype
        crossed = random.uniform("pairs", shape, dtype) < self.rate
        share = jnp.where(crossed, random.uniform("share", shape, dtype), 1.0)
        a = share * first + (1.0 - share) * second
        b = share * second + (1.0 - share) * first
        return jnp.clip(jnp.concatenate([a, b]), 0.0, 1.0)


@pytree
class Polynomial:
    """See :func:`polynomial`."""

    eta: Any
    rate: Any

    def __call__(self, random, children):
        shape, dtype = children.shape, children.dtype
        u = random.uniform("mutation", shape, dtype)
        power, exponent = self.eta + 1.0, 1.0 / (self.eta + 1.0)
        down = (2.0 * u + (1.0 - 2.0 * u) * (1.0 - children) ** power) ** exponent - 1.0
        up = 1.0 - (2.0 * (1.0 - u) + (2.0 * u - 1.0) * children**power) ** exponent
        mutant = jnp.clip(children + jnp.where(u < 0.5, down, up), 0.0, 1.0)
        return jnp.where(_hit(random, self.rate, children), mutant, children)


@pytree
class Gaussian:
    """See :func:`gaussian`."""

    scale: Any
    rate: Any

    def __call__(self, random, children):
        noise = self.scale * random.normal("mutation", children.shape, children.dtype)
        mutant = jnp.clip(children + noise, 0.0, 1.0)
        return jnp.where(_hit(random, self.rate, children), mutant, children)


@pytree
class Uniform:
    """See :func:`uniform`."""

    rate: Any

    def __call__(self, random, children):
        mutant = random.uniform("mutation", children.shape, children.dtype)
        return jnp.where(_hit(random, self.rate, children), mutant, children)


def _rate(rate):
    return None if rate is None else coefficient("rate", rate, lower=0.0, upper=1.0)


def _hit(random, rate, children):
    rate = 1.0 / children.shape[1] if rate is None else rate
    return random.uniform("mutated", children.shape, children.dtype) < rate
