r"""Levenberg-Marquardt from a good start: the last digits of an output-error fit.

Each step solves the damped linear problem

.. math:: \min_s \| J s + r \|^2 + \mu \| D s \|^2

by least squares on the stacked matrix (never the normal equations), D the largest column norms of J
seen so far, so that units do not matter; a step that lowers the value shrinks the damping, any other
(a diverging simulation included) raises it.

Reference: J. J. More, "The Levenberg-Marquardt algorithm: implementation and theory", 1978.
"""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.identify.simulation_error.experiment import Experiment, OutputProblem, start_names
from jaxswarm.identify.simulation_error.output_error import output_residual

_PERFECT = 1e-18  # value that only simulated data without noise reach


@dataclasses.dataclass(frozen=True)
class OutputFit:
    """Result of a refinement.

    Attributes:
        values: Value of each free parameter by name, errors of the starts included.
        std_error: Standard error of each, for white residuals.
        value: Sum of squared residuals, the fitness times the number of experiments.
        num_steps: Steps tried.
        converged: Whether the last step changed the value by less than the tolerance.
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
        num_steps: Largest number of steps, >= 1.
        tolerance: Relative decrease of the value at which it stops.

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
    value, damping, scale = float(r @ r), 1e-3, np.zeros(x.size)
    converged, steps = False, 0
    jacobian = np.asarray(derive(jnp.asarray(x), experiments))
    while steps < num_steps and not converged:
        steps += 1
        scale = np.maximum(scale, np.linalg.norm(jacobian, axis=0))
        _check_influence(names, scale)
        step = _step(jacobian / scale, r, damping) / scale
        trial = np.asarray(evaluate(x + step, experiments))
        lower = float(trial @ trial) if np.isfinite(trial).all() else np.inf
        if lower < value:
            converged = value - lower < tolerance * value or lower < _PERFECT
            x, r, value, damping = x + step, trial, lower, max(damping / 5.0, 1e-12)
            jacobian = np.asarray(derive(jnp.asarray(x), experiments))
        else:
            damping *= 4.0
            converged = damping > 1e9 or np.linalg.norm(step * scale) < tolerance * np.sqrt(value)
    errors = _standard_errors(jacobian, value, r.size)
    return OutputFit(
        dict(zip(names, map(float, x), strict=True)),
        dict(zip(names, map(float, errors), strict=True)),
        value,
        steps,
        bool(converged),
    )


def _check_influence(free: tuple[str, ...], scale: np.ndarray) -> None:
    dead = [name for name, size in zip(free, scale, strict=True) if not size > 0.0]
    if dead:
        raise InputError(f"{', '.join(dead)} changes nothing in the motion: do not free it.")


def _step(jacobian: np.ndarray, r: np.ndarray, damping: float) -> np.ndarray:
    size = jacobian.shape[1]
    stacked = np.vstack([jacobian, np.sqrt(damping) * np.eye(size)])
    right = np.concatenate([-r, np.zeros(size)])
    return np.linalg.lstsq(stacked, right, rcond=None)[0]


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
