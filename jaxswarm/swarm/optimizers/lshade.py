"""L-SHADE: success-history differential evolution whose population falls linearly to four members.

How a step of fixed size goes with a shrinking population is told in
:mod:`~jaxswarm.swarm.optimizers.shade`.

Reference:
    R. Tanabe, A. Fukunaga, "Improving the search performance of SHADE using linear population size
    reduction", CEC 2014, doi 10.1109/CEC.2014.6900380.
"""

from typing import Any

from jaxswarm.swarm.optimizers.base import at_least
from jaxswarm.swarm.optimizers.crowd import Crowd
from jaxswarm.swarm.optimizers.shade import SHADE, shade
from jaxswarm.swarm.pytree import replace
from jaxswarm.swarm.schedules import BY_HAND, linear, run_length

__all__ = ["lshade"]


def lshade(
    num_particles: int | None = None,
    num_steps: float | None = None,
    *,
    population: int | None = None,
    **options: Any,
) -> SHADE:
    """SHADE whose population falls linearly to 4 over ``num_steps``, with six remembered pairs.

    The published population is meant for 10,000 evaluations a dimension; shorter runs begin with fewer.

    Args:
      num_particles: n, trials in every step, at least 8; default two a dimension, known when the search
        begins.
      num_steps: updates over which the population shrinks; default as many as ``minimize`` makes.
      population: members at the start, at least n; default n if that is given, else 18 a dimension times
        the square root of the run's evaluations over 10,000 a dimension, where that is less.
      **options: further keyword arguments of :func:`~jaxswarm.swarm.optimizers.shade.shade`.

    >>> import jax
    >>> state = lshade().init(jax.random.key(0), 5)
    >>> state.position.shape, state.members.shape
    ((10, 5), (90, 5))
    """
    known: dict[str, Any] = {} if num_particles is None else {"num_particles": num_particles}
    optimizer = shade(**known, **(dict(num_memories=6) | options))
    n = None if num_particles is None else optimizer.num_particles
    if population is not None:
        population = at_least("population", population, n or 1, "every trial has a target")
    free = population is None and n is None
    return replace(
        optimizer,
        living=linear(1.0, 0.0, num_steps),
        crowd=Crowd(*run_length(num_steps, BY_HAND)) if free else None,
        num_particles=n,
        population=population,
    )
