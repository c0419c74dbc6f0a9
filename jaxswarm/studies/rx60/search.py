r"""Searches of the RX60 problem: coordinates, schemes, many runs at once, and what is kept of them.

Three coordinate systems describe the same problem, :math:`\|R\theta - z\|`:

- raw: the paper's thirteen parameters, two directions of which the data cannot see;
- base: the eleven combinations the data can tell apart, in the box that the raw box spans;
- whitened: :math:`u = R_b \theta_b`, in which the fitness is a sphere, in the box that the base box spans.

In all three the fitness is ``|F x - z|`` with another matrix F, so the program is the same.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.identify.estimation.base_parameters import BaseParameters, find_base
from jaxswarm.studies.rx60.data import Compressed, bounds
from jaxswarm.studies.rx60.paper import NAMES
from jaxswarm.swarm import Space, aelspso, gpso, minimize_runs

COORDINATES = ("raw", "base", "whitened")
PARTICLES = 24


@dataclass(frozen=True)
class View:
    """The problem in one coordinate system.

    Attributes:
        name: One of :data:`COORDINATES`.
        factor: F, shape (13, d).
        target: z, shape (13,).
        rest: rho^2.
        lower, upper: The box, shape (d,).
        to_base: (11, d), the base combinations of a point are ``to_base @ x``.
    """

    name: str
    factor: np.ndarray
    target: np.ndarray
    rest: float
    lower: np.ndarray
    upper: np.ndarray
    to_base: np.ndarray

    @property
    def optimum(self) -> float:
        """Least fitness of the linear problem (least squares)."""
        best = np.linalg.lstsq(self.factor, self.target, rcond=1e-9)[0]
        return float(np.sqrt(((self.factor @ best - self.target) ** 2).sum() + self.rest))


@dataclass(frozen=True)
class Search:
    """Outcome of the runs of one scheme; arrays lead with the runs.

    Attributes:
        points: Best points in the coordinates of the search, (runs, d).
        values: fbest, (runs,).
        history: Best value after each step, (runs, steps).
        inertia: Inertia weight of each step, NaN where the scheme has none, (runs, steps).
        diversity: Spread of the candidates in the unit cube, (runs, steps).
        per_step: Evaluations a step costs one run.
    """

    points: np.ndarray
    values: np.ndarray
    history: np.ndarray
    inertia: np.ndarray
    diversity: np.ndarray
    per_step: int

    def evaluations_to(self, level: float) -> float | None:
        """Median evaluations until the fitness is at most ``level``; None if half the runs never are."""
        reached = self.history <= level
        steps = np.where(reached.any(axis=1), reached.argmax(axis=1) + 1.0, np.inf)
        middle = float(np.median(steps))
        return middle * self.per_step if np.isfinite(middle) else None


def base_of(problem: Compressed) -> BaseParameters:
    """The parameter combinations that the experiment can see."""
    return find_base(problem.factor, NAMES)


def view(problem: Compressed, coordinates: str = "raw", stretch: float = 1.0) -> View:
    """The problem in a coordinate system of :data:`COORDINATES`."""
    lower, upper = bounds(stretch)
    base = base_of(problem)
    reduce = base.reduce(np.eye(13)).T
    if coordinates == "raw":
        given = (problem.factor, problem.target, problem.rest, lower, upper, reduce)
        return View("raw", *given)
    factor, to_base = problem.factor[:, base.kept], np.eye(base.size)
    lower, upper = _image_of_box(reduce, lower, upper)
    if coordinates == "whitened":
        factor, triangle = np.linalg.qr(factor)
        lower, upper = _image_of_box(triangle, lower, upper)
        to_base = np.linalg.inv(triangle)
    return View(coordinates, factor, problem.target, problem.rest, lower, upper, to_base)


def _image_of_box(matrix, lower, upper):
    """The smallest box that holds ``matrix @ x`` for all x of a box."""
    middle, half = matrix @ (lower + upper) / 2.0, np.abs(matrix) @ (upper - lower) / 2.0
    return middle - half, middle + half


def torque_fitness(x: jax.Array, problem: tuple) -> jax.Array:
    """sqrt(||F x - z||^2 + rho^2) of a population (m, d), shape (m,)."""
    factor, target, rest = problem
    return jnp.sqrt(jnp.sum((x @ factor.T - target) ** 2, axis=1) + rest)


def _record(state: Any, info: Any):
    return info.value_best, info.hyper.get("inertia", jnp.nan), info.diversity


def search(at: View, optimizer: Any, key: jax.Array, *, runs: int, num_steps: int) -> Search:
    """Run a scheme from many keys as one program."""
    problem = jax.tree.map(jnp.asarray, (at.factor, at.target, at.rest))
    space = Space.vector(at.lower, at.upper)
    keys = jax.random.split(key, runs)
    result = minimize_runs(
        torque_fitness, optimizer, space, keys, problem, num_steps=num_steps, record=_record
    )
    best, inertia, diversity = (
        np.asarray(jnp.broadcast_to(h, (runs, num_steps))) for h in result.history
    )
    per_step = int(result.num_evaluations[0]) // num_steps
    points, values = np.asarray(result.params), np.asarray(result.value)
    return Search(points, values, best, inertia, diversity, per_step)


def scheme(name: str, num_steps: int, **options: Any):
    """The paper's schemes by name, as reconstructed; options as of ``gpso`` and ``aelspso``."""
    factories: dict[str, Callable[..., Any]] = {"gpso": gpso, "aelspso": aelspso}
    factory = factories[name]
    return factory(PARTICLES, num_steps, **options)


def summary(found: Search, at: View) -> dict:
    """The numbers of a table row."""
    return {
        "fbest_mean": float(found.values.mean()),
        "fbest_median": float(np.median(found.values)),
        "fbest_std": float(found.values.std(ddof=1)) if len(found.values) > 1 else 0.0,
        "fbest_max": float(found.values.max()),
        "least_squares": at.optimum,
        "evaluations": found.per_step * found.history.shape[1],
        "final_diversity": float(np.median(found.diversity[:, -1])),
        "mean_inertia": float(np.nanmean(found.inertia))
        if np.isfinite(found.inertia).any()
        else None,
    }
