r"""Levenberg-Marquardt from a good start: the last digits of an output-error fit.

MINPACK's method by way of SciPy: scaled by the largest column norms of the Jacobian seen so far, so that units
do not matter, and solved by orthogonal factors, never by the normal equations. A diverging simulation is a
step that raises the value.

Reference: J. J. More, "The Levenberg-Marquardt algorithm: implementation and theory", 1978.
"""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import scipy

from jaxswarm.errors import InputError
from jaxswarm.identify.simulation_error.experiment import Experiment, OutputProblem, start_names
from jaxswarm.identify.simulation_error.output_error import output_residual


@dataclasses.dataclass(frozen=True)
class OutputFit:
    """Result of a refinement.

    Attributes:
        values: Value of each free parameter by name, errors of the starts included.
        std_error: Standard error of each, for white residuals.
        value: Sum of squared residuals, the fitness times the number of experiments.
        num_steps: Simulations of all logs.
        converged: Whether it stopped by the tolerance.
    """

    values: dict[str, float]
    std_error: dict[str, float]
    value: float
    num_steps: int
    converged: bool


def refine_output(
    problem: OutputProblem,
    experiments: tuple[Experiment, ...],
    start: dict[str, float],
    *,
    num_steps: int = 30,
    tolerance: float = 1e-9,
) -> OutputFit:
    """Descend from a start by Levenberg-Marquardt on the output error.

    Args:
        problem: What is free and what counts.
        experiments: The logs.
        start: A value for every free name, e.g. a swarm's best; errors of the starts begin at zero
            where they are not given.
        num_steps: Largest number of simulations of all logs, >= 1.
        tolerance: Relative decrease of the value, and relative step, at which it stops.

    Raises:
        InputError: If a start is missing, the simulation diverges there, or a free parameter has
            no influence on the motion.
    """
    _check_start(problem, start)
    extra = start_names(problem, len(experiments))
    names, start = problem.free + extra, {**dict.fromkeys(extra, 0.0), **start}
    residual = output_residual(problem)
    evaluate = jax.jit(residual)
    derive = jax.jit(jax.jacfwd(residual))
    x = np.array([float(start[name]) for name in names])
    r = np.asarray(evaluate(x, experiments))
    if not np.isfinite(r).all():
        raise InputError(
            "the simulation diverges at the start of the refinement: start closer, or use substeps."
        )
    _check_influence(names, np.asarray(derive(jnp.asarray(x), experiments)))
    found = scipy.optimize.least_squares(
        lambda x: _bounded(np.asarray(evaluate(x, experiments)), r),
        x,
        lambda x: np.asarray(derive(jnp.asarray(x), experiments)),
        method="lm",
        x_scale="jac",
        ftol=tolerance,
        xtol=tolerance,
        gtol=np.finfo(float).eps,
        max_nfev=num_steps,
    )
    value = 2.0 * float(found.cost)
    errors = _standard_errors(found.jac, value, r.size)
    return OutputFit(
        dict(zip(names, map(float, found.x), strict=True)),
        dict(zip(names, map(float, errors), strict=True)),
        value,
        int(found.nfev),
        found.status > 0,
    )


def _check_influence(free: tuple[str, ...], jacobian: np.ndarray) -> None:
    dead = [n for n, column in zip(free, jacobian.T, strict=True) if not np.abs(column).max() > 0.0]
    if dead:
        raise InputError(f"{', '.join(dead)} changes nothing in the motion: do not free it.")


def _bounded(residual: np.ndarray, start: np.ndarray) -> np.ndarray:
    """The residual, far above that of the start where the simulation diverged."""
    if np.isfinite(residual).all():
        return residual
    return np.full(start.shape, 1e3 * (np.abs(start).max() + 1.0))


def _standard_errors(jacobian: np.ndarray, value: float, count: int) -> Any:
    upper = np.linalg.qr(jacobian, mode="r")
    freedom = max(count - jacobian.shape[1], 1)
    inverse = np.linalg.pinv(upper)
    return np.sqrt(value / freedom * np.sum(inverse**2, axis=1))


def _check_start(problem: OutputProblem, start: dict[str, float]) -> None:
    """Refuse a start without a value for every free parameter."""
    missing = [name for name in problem.free if name not in start]
    if missing:
        raise InputError(
            f"no start for {', '.join(missing)}: give a value for each free parameter."
        )
