r"""Output error: parameters for which the simulated motion is the measured one.

The plant gets the measured input, or the controller's reference, and starts where the log starts; the
value of a candidate is

.. math:: J = \mathrm{mean}\left[\left((\hat q - q)/\sigma_q\right)^2\right]
          + \mathrm{mean}\left[\left((\hat{\dot q} - \dot q)/\sigma_{\dot q}\right)^2\right],

the second term only where velocities are given. Nothing is differentiated, so noise in the motion does
not bias the estimate; a wrong model shows in the motion and not only in the torque. A whole population
runs as lanes of one scan that keeps a sum of squares and no motion; a candidate that diverges gets
+inf and leaves the others alone. From the best one, Levenberg-Marquardt descends with exact forward
derivatives of the simulation. Where a log starts is measured too, with noise, so an error of position
and velocity at its first sample can be free for each log.

Reference: L. Ljung, System Identification, 1999, section 3.4; M. Gautier, A. Janot, P.-O. Vandanjon,
"A new closed-loop output error method for parameter identification of robot dynamics", IEEE TCST 21(2),
2013.
"""

from collections.abc import Callable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.identify.simulation_error.experiment import (
    Experiment,
    OutputProblem,
    plant_with,
    start_names,
)
from jaxswarm.robot.lanes import in_blocks
from jaxswarm.simulate.acceleration import motor_side, rest
from jaxswarm.simulate.controllers import Reference
from jaxswarm.simulate.loops import Loop, closed_loop, open_loop
from jaxswarm.simulate.plant import Plant


def output_fitness(problem: OutputProblem) -> Callable[[dict, tuple[Experiment, ...]], jax.Array]:
    """Return ``fn(params, experiments) -> (P,)`` for ``minimize(..., vectorized=True)``.

    ``params`` holds a (P,) array for each free name and each of :func:`start_names`. Build it once
    and keep it: a function that is the same object is not compiled again.

    Raises:
        InputError: On unknown names, or a period of the controller that is no multiple of ``dt``.
    """
    plant_with(problem.plant, problem.free, [0.0] * len(problem.free))

    def value(lanes: list[jax.Array], experiments: tuple[Experiment, ...]) -> jax.Array:
        plant, shifts = _candidate(problem, lanes, len(experiments))
        shape = lanes[0].shape
        parts = zip(experiments, shifts, strict=True)
        errors = (_squared_error(problem, plant, e, shift, shape) for e, shift in parts)
        return sum(errors, jnp.zeros(shape))

    def fitness(params: dict, experiments: tuple[Experiment, ...]) -> jax.Array:
        names = problem.free + start_names(problem, len(experiments))
        total = in_blocks(value, [jnp.asarray(params[name]) for name in names], experiments)
        return jnp.where(jnp.isfinite(total), total / len(experiments), jnp.inf)

    return fitness


def _candidate(problem: OutputProblem, values: Sequence[Any], num_experiments: int):
    """Return the plant, and for each experiment what is added to positions and velocities."""
    split, n = len(problem.free), problem.plant.robot.num_joints
    plant = plant_with(problem.plant, problem.free, values[:split])
    starts = list(values[split:])
    if not starts:
        return plant, [None] * num_experiments
    rows = [starts[k : k + n] for k in range(0, len(starts), n)]
    return plant, list(zip(rows[::2], rows[1::2], strict=True))


def _loop(problem: OutputProblem, e: Experiment, lanes: tuple[int, ...]) -> Loop:
    dt, steps, external = problem.dt, problem.substeps, e.external
    if problem.controller is None:
        return open_loop(e.drive, hold=problem.hold, dt=dt, substeps=steps, external=external)
    return closed_loop(
        problem.controller,
        Reference(*e.drive),
        lanes=lanes,
        control_dt=problem.control_dt,
        dt=dt,
        substeps=steps,
        external=external,
    )


def _start(plant: Plant, e: Experiment, shift, lanes: tuple[int, ...]):
    def spread(x):
        x = jnp.asarray(x, float)
        return jnp.broadcast_to(x.reshape(x.shape + (1,) * len(lanes)), (*x.shape, *lanes))

    q, dq = spread(e.start_q), spread(e.start_dq)
    if shift is not None:
        q, dq = q + jnp.stack(shift[0]), dq + jnp.stack(shift[1])
    return rest(plant, q, dq)


def _squared_error(problem: OutputProblem, plant: Plant, e: Experiment, shift, lanes) -> jax.Array:
    """Value of every lane on one experiment, shape ``lanes``."""
    loop = _loop(problem, e, lanes)
    n = plant.robot.num_joints
    weight_q = 1.0 / np.asarray(problem.sigma_q) ** 2
    with_dq = e.dq is not None and problem.sigma_dq is not None
    weight_dq = 1.0 / np.asarray(problem.sigma_dq) ** 2 if with_dq else None
    measured = (e.q, e.dq) if with_dq else (e.q, None)

    def body(carry, sample):
        inner, total = carry
        inputs, (q, dq) = sample
        inner, (state, _) = loop.advance(plant, inner, inputs)
        at_q, at_dq = motor_side(plant, state)
        for j in range(n):
            total = total + weight_q[j] * (at_q[j] - q[j]) ** 2
            if with_dq:
                total = total + weight_dq[j] * (at_dq[j] - dq[j]) ** 2
        return (inner, total), None

    start = (loop.begin(_start(plant, e, shift, lanes)), jnp.zeros(lanes))
    (_, total), _ = jax.lax.scan(body, start, (loop.inputs, measured))
    return total / (n * e.q.shape[0])


def output_residual(
    problem: OutputProblem,
) -> Callable[[jax.Array, tuple[Experiment, ...]], jax.Array]:
    """Return ``fn(values, experiments) -> (R,)`` whose sum of squares is that of the fitnesses.

    ``values`` (d,) are those of the free names, then of :func:`start_names`.

    Raises:
        InputError: On unknown names.
    """
    plant_with(problem.plant, problem.free, [0.0] * len(problem.free))

    def residual(values: jax.Array, experiments: tuple[Experiment, ...]) -> jax.Array:
        plant, shifts = _candidate(problem, list(values), len(experiments))
        parts = zip(experiments, shifts, strict=True)
        return jnp.concatenate([_residual(problem, plant, e, shift) for e, shift in parts])

    return residual


def _residual(problem: OutputProblem, plant: Plant, e: Experiment, shift) -> jax.Array:
    loop = _loop(problem, e, ())

    def body(carry, sample):
        carry, (state, _) = loop.advance(plant, carry, sample)
        q, dq = motor_side(plant, state)
        return carry, (jnp.stack(q), jnp.stack(dq))

    _, (q, dq) = jax.lax.scan(body, loop.begin(_start(plant, e, shift, ())), loop.inputs)
    parts = [((q - e.q) / np.asarray(problem.sigma_q)).ravel()]
    if e.dq is not None and problem.sigma_dq is not None:
        parts.append(((dq - e.dq) / np.asarray(problem.sigma_dq)).ravel())
    return jnp.concatenate(parts) / np.sqrt(e.q.size)
