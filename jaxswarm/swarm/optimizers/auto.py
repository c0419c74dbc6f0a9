"""One default: which strategy to take, from what is known before a search.

Known when a search begins are the number of dimensions d, and possibly how many evaluations there may be,
how many candidates are evaluated side by side, and whether values are noisy. The rules, first that holds:

    d above 200                                      lm_ma_es: a matrix of d^2 numbers is not learned
    fewer than 6 d^2 evaluations, d at least 10      sep_cma_es: too few to learn correlations
    noisy                                            ipop_cma_es from a population four times the default
    d at most 5, 50 d^2 to 10,000 d evaluations      lshade: one population that sees many valleys
    else                                             bipop_cma_es: nothing is known, so a bit of everything

A number of candidates to evaluate side by side rules ``lshade`` out, whose population follows the budget.
``python -m benchmarks.bbob`` shows what they rest on: of the targets in 5-D with 1,000 evaluations a
dimension 0.73 by lshade and 0.69 by bipop_cma_es, with 100 a dimension 0.20 and 0.24, in 10-D 0.48 and
0.61; in 20-D with 100 a dimension 0.14 by sep_cma_es, 0.13 by bipop_cma_es and 0.10 by lshade. With 10,000
a dimension lshade and bipop_cma_es reach 0.962 and 0.954 in 2-D, 0.944 and 0.905 in 3-D (instances 1-15),
0.851 and 0.804 in 5-D (1-4): more where coordinates have valleys of their own or there is no structure, in
5-D less where many valleys lie in one wide one. The state is that of the strategy taken.
"""

from typing import Any

import jax

from jaxswarm.swarm.optimizers.base import at_least, dimensions
from jaxswarm.swarm.optimizers.cma_es import default_population
from jaxswarm.swarm.optimizers.cma_restarts import bipop_cma_es, ipop_cma_es
from jaxswarm.swarm.optimizers.crowd import default_trials
from jaxswarm.swarm.optimizers.lm_ma_es import lm_ma_es
from jaxswarm.swarm.optimizers.lshade import lshade
from jaxswarm.swarm.optimizers.sep_cma_es import sep_cma_es
from jaxswarm.swarm.pytree import pytree, static
from jaxswarm.swarm.random import check_source

__all__ = ["Auto", "auto"]

LARGE = 200
"""Dimensions above which an eigendecomposition costs more than most objectives."""
LEARNING = 6
"""Evaluations over d^2 below which CMA-ES has not learned more than scales: 60 a dimension in 10-D."""
FEW = 10
"""Dimensions below which learning correlations takes no time worth saving."""
FEW_FOR_POPULATIONS = 5
FROM, UP_TO = 50, 10_000
"""Dimensions, evaluations over d^2 and evaluations over d between which L-SHADE reaches more targets."""
AGAINST_NOISE = 4
"""Times the default population: the mean over more candidates is what averages noise out."""


@pytree
class Auto:
    """See :func:`auto`."""

    num_particles: int | None = static()
    num_evaluations: int | None = static()
    noisy: bool = static()
    random: str = static()

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> Any:
        """The first state of the strategy for so many dimensions."""
        num_dims = dimensions(num_dims)
        return self.choose(num_dims).init(key, num_dims, dtype)

    def update(self, key: jax.Array, state: Any, value: jax.Array):
        """The update of the strategy for so many dimensions."""
        return self.choose(state.position.shape[1]).update(key, state, value)

    def choose(self, num_dims: int) -> Any:
        """Return the optimizer that is used in ``num_dims`` dimensions."""
        n, random = self.num_particles, self.random
        budget = self.num_evaluations
        if num_dims > LARGE:
            return lm_ma_es(n, random=random)
        if budget is not None and num_dims >= FEW and budget < LEARNING * num_dims**2:
            return sep_cma_es(n, random=random)
        if self.noisy:
            return ipop_cma_es(n or AGAINST_NOISE * default_population(num_dims), random=random)
        small = num_dims <= FEW_FOR_POPULATIONS and n is None
        if small and budget is not None and FROM * num_dims**2 <= budget <= UP_TO * num_dims:
            return lshade(num_steps=budget / default_trials(num_dims), random=random)
        return bipop_cma_es(n, random=random)


def auto(
    num_particles: int | None = None,
    *,
    num_evaluations: int | None = None,
    noisy: bool = False,
    random: str = "hash",
) -> Auto:
    """Choose a strategy from what is known: dimension, budget, parallel width, noise.

    Args:
      num_particles: candidates evaluated side by side in every step, at least 4; default what suits
        the strategy.
      num_evaluations: evaluations there will be; default unknown, taken for many.
      noisy: whether the same candidate may get different values.
      random: ``"hash"`` or ``"threefry"``.

    >>> type(auto().choose(20)).__name__, type(auto().choose(1000)).__name__
    ('CMARestarts', 'LMMAES')
    """
    if num_particles is not None:
        num_particles = at_least("num_particles", num_particles, 4, "half of them are parents")
    if num_evaluations is not None:
        num_evaluations = at_least("num_evaluations", num_evaluations, 1, "nothing could be tried")
    return Auto(num_particles, num_evaluations, bool(noisy), check_source(random))
