"""What output error compares: logs to be simulated, the plant, and which of its parameters are free."""

import dataclasses
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax
import numpy as np

from jaxswarm.errors import InputError, nearest
from jaxswarm.robot.names import standard_parameter_names
from jaxswarm.simulate.controllers import Controller
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
