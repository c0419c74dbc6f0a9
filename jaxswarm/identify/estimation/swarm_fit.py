r"""The same linear problem by a swarm: torque fitness through the triangular factor.

The weighted torque error of base parameters :math:`\theta` is :math:`\|R\theta - z\|^2 + c` exactly,
whatever the length of the log, so a particle costs :math:`b^2` operations and no digits near the
optimum are lost (the Gram form :math:`\theta^T W^T W \theta - \dots` loses half of them). Least
squares solves this at once; the swarm's cost beside that optimum says how far a search got. The valley
of the quadratic is as long as the condition number of R, which is what plain swarms fail on; with
``whiten`` they search :math:`u = R\theta` instead, where it is a sphere.
"""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
import scipy

from jaxswarm.identify.estimation.least_squares import Fit, base_bounds
from jaxswarm.swarm import Space, find_optimizer, minimize_runs
from jaxswarm.swarm.needed import refuse_too_many
from jaxswarm.swarm.optimizers.products import over_columns
from jaxswarm.waiting import wait_for

# Half width of the search box, in units of the value at which one parameter alone explains the torque.
_REACH = 3.0


@dataclass(frozen=True)
class SwarmFit:
    """What a swarm found on the problem of a :class:`Fit`.

    Attributes:
        optimizer: Its name.
        whiten: Whether it searched whitened coordinates.
        values: Best base parameters over all runs, shape (b,).
        costs: Final weighted cost of every run, shape (runs,).
        optimum: Cost of the least-squares solution.
        history: Best cost after every step, shape (runs, steps).
        evaluations: Candidates evaluated, all runs together.
        outside: Number of parameters whose least-squares value lies outside the search box.
    """

    optimizer: str
    whiten: bool
    values: np.ndarray
    costs: np.ndarray
    optimum: float
    history: np.ndarray
    evaluations: int
    outside: int

    @property
    def excess(self) -> np.ndarray:
        """(cost - optimum) / optimum of every run."""
        return (self.costs - self.optimum) / self.optimum


def torque_cost(theta: jax.Array, problem: tuple[jax.Array, jax.Array, jax.Array]) -> jax.Array:
    """Weighted cost of a population: ``||R theta - z||^2 + c`` for ``theta`` (m, b), shape (m,).

    >>> torque_cost(jnp.array([[1.0], [2.0]]), (jnp.array([[2.0]]), jnp.array([2.0]), 1.0))
    Array([1., 5.], dtype=float64)
    """
    factor, target, rest = problem
    return jnp.sum((over_columns(theta, factor) - target) ** 2, axis=1) + rest


def swarm_fit(
    solution: Fit,
    name: str,
    key: jax.Array,
    *,
    runs: int = 10,
    num_steps: int = 500,
    whiten: bool = False,
    lower: np.ndarray | None = None,
    upper: np.ndarray | None = None,
) -> SwarmFit:
    """Search the base parameters of a fitted problem with a named optimizer.

    Args:
        solution: The least-squares solution that carries R, z and the cost.
        name: Name of an optimizer (``jaxswarm optimizers`` lists them).
        key: Random key.
        runs: Independent runs, searched as one population.
        num_steps: Steps of each.
        whiten: Search ``u = R theta`` instead of ``theta``.
        lower, upper: Physical bounds of the full parameters, used for the box where not whitened.

    Raises:
        InputError: If there is no such optimizer, or not the memory for so many runs and steps.
    """
    optimizer = find_optimizer(name).factory()
    size, reach = solution.base.size, _REACH * np.linalg.norm(solution.target)
    if whiten:
        factor = np.eye(size)
        box = np.full(size, reach)
        low, high, best = -box, box, solution.factor @ solution.values
    else:
        factor = solution.factor
        box = reach / np.linalg.norm(factor, axis=0)
        low, high = base_bounds(solution.base, lower, upper)
        low, high, best = np.maximum(low, -box), np.minimum(high, box), solution.values
    space = Space.vector(low, high)
    problem = (jnp.asarray(factor), jnp.asarray(solution.target), jnp.asarray(solution.cost))
    refuse_too_many(optimizer, space, num_steps, runs)  # before there is a key for every run
    result = minimize_runs(
        torque_cost, optimizer, space, jax.random.split(key, runs), problem, num_steps=num_steps
    )
    wait_for(result)  # millions of steps are one program
    costs = np.asarray(result.value)
    found = np.asarray(result.params)[int(np.argmin(costs))]
    values = scipy.linalg.solve_triangular(solution.factor, found) if whiten else found
    optimum = float(
        ((solution.factor @ solution.values - solution.target) ** 2).sum() + solution.cost
    )
    return SwarmFit(
        optimizer=name,
        whiten=whiten,
        values=values,
        costs=costs,
        optimum=optimum,
        history=np.asarray(result.history),
        evaluations=int(np.sum(np.asarray(result.num_evaluations))),
        outside=int(((best < low) | (best > high)).sum()),
    )
