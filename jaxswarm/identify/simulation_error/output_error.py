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

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError, nearest
from jaxswarm.robot.lanes import in_blocks
from jaxswarm.robot.names import standard_parameter_names
from jaxswarm.simulate.acceleration import motor_side, rest
from jaxswarm.simulate.controllers import Controller, Reference
from jaxswarm.simulate.loops import Loop, closed_loop, open_loop
from jaxswarm.simulate.plant import Plant


class Experiment(NamedTuple):
    """One log for output error; all arrays at the same samples.

    Attributes:
        drive: Motor torques (T, n) in N m or N, or the :class:`Reference` of the controller.
        q: (T, n), measured positions in rad or m.
        start_q: (n,), position at the first sample.
        start_dq: (n,), velocity at the first sample.
        dq: (T, n), measured velocities, or None.
        external: (T, n), torques of the surroundings, or None.
    """

    drive: Any
    q: jax.Array
    start_q: jax.Array
    start_dq: jax.Array
    dq: jax.Array | None = None
    external: jax.Array | None = None


@dataclasses.dataclass(frozen=True, eq=False)
class OutputProblem:
    """What is simulated, what is free, and what counts.

    Attributes:
        plant: The plant with values for everything that is not free.
        free: Names: standard parameters (``"m1"``, ``"Izz3"``) and parameters of effects
            (``"b_joint2:viscous_friction"``), see :func:`free_names`.
        dt: Distance of the samples in s.
        sigma_q: (n,), scale of the position error in rad or m.
        sigma_dq: (n,), scale of the velocity error; used where an experiment has velocities.
        controller: The known controller, None for open loop.
        control_dt: Its period in s, default ``dt``.
        hold: Hold of the torques in open loop, ``"zero"`` or ``"first"``.
        substeps: RK4 steps per sample.
        free_start: Whether errors of the starts are free too, see :func:`start_names`.
    """

    plant: Plant
    free: tuple[str, ...]
    dt: float
    sigma_q: np.ndarray
    sigma_dq: np.ndarray | None = None
    controller: Controller | None = None
    control_dt: float | None = None
    hold: str = "zero"
    substeps: int = 1
    free_start: bool = False


def free_names(plant: Plant) -> tuple[str, ...]:
    """Return every name that may be free: link parameters, then ``parameter_joint:effect``."""
    joints = plant.robot.joints
    names = list(standard_parameter_names(plant.robot))
    for acting in plant.acting:
        where = "" if acting.joint is None else f"_{joints[acting.joint]}"
        where += "" if acting.other is None else f"_{joints[acting.other]}"
        names += [f"{name}{where}:{acting.effect}" for name in acting.values]
    return tuple(names)


def start_names(problem: OutputProblem, num_experiments: int) -> tuple[str, ...]:
    """Return the names of what is added to the starts, ``q0_joint1@0`` and ``dq0_joint1@0`` first.

    The number behind ``@`` counts the experiments. Empty unless ``problem.free_start``.
    """
    if not problem.free_start:
        return ()
    joints = problem.plant.robot.joints
    return tuple(
        f"{quantity}_{joint}@{k}"
        for k in range(num_experiments)
        for quantity in ("q0", "dq0")
        for joint in joints
    )


def plant_with(plant: Plant, names: Sequence[str], values: Sequence[Any]) -> Plant:
    """Return the plant with values (entries, lanes allowed) in place of the named parameters.

    Raises:
        InputError: On a name that is not in :func:`free_names`.
    """
    known = free_names(plant)
    for name in names:
        if name not in known:
            raise InputError(f"no parameter {name!r} to free. {nearest(name, known)}")
    given = dict(zip(names, values, strict=True))
    n = plant.robot.num_joints
    rows = np.asarray(plant.robot.parameters).tolist()
    rows = tuple(
        tuple(given.get(known[10 * i + k], rows[i][k]) for k in range(10)) for i in range(n)
    )
    left = iter(known[10 * n :])
    acting = tuple(
        dataclasses.replace(
            a, values={name: given.get(next(left), value) for name, value in a.values.items()}
        )
        for a in plant.acting
    )
    return plant.replace(robot=plant.robot.replace(parameters=rows), acting=acting)


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
        return sum(_squared_error(problem, plant, e, shift, shape) for e, shift in parts)

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
    options = {"dt": problem.dt, "substeps": problem.substeps, "external": e.external}
    if problem.controller is None:
        return open_loop(e.drive, hold=problem.hold, **options)
    reference = Reference(*e.drive)
    return closed_loop(
        problem.controller, reference, lanes=lanes, control_dt=problem.control_dt, **options
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
