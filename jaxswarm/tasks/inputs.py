"""What users pass to a task, turned into what the library works on."""

import functools
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import ParamSpec, TypeVar

import jax
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.identify.forward.model import Model, load_model
from jaxswarm.logs import Log, LogChoice, read_log
from jaxswarm.logs.repeated import refuse_repeated_stretches
from jaxswarm.robot import Robot, RobotChoice, load_robot
from jaxswarm.room import room_for_programs

OneLog = Log | LogChoice | str | Path
Logs = OneLog | Sequence[OneLog]
P = ParamSpec("P")
T = TypeVar("T")


def in_double(function: Callable[P, T]) -> Callable[P, T]:
    """Run a task in double precision: in single precision columns of a robot look dependent that are not.

    It begins with room for its programs, so that thousands of tasks can run in one process.
    """

    @functools.wraps(function)
    def run(*args: P.args, **kwargs: P.kwargs) -> T:
        room_for_programs()
        with jax.enable_x64(True):
            return function(*args, **kwargs)

    return run


def as_robot(robot: Robot | RobotChoice | str | Path) -> Robot:
    """A robot, or the built-in name or file, with options or without, that stands for one."""
    return robot if isinstance(robot, Robot) else load_robot(robot)


def as_model(model: Model | str | Path) -> Model:
    """A model, or the ``model.json`` it is kept in; also what carries one as ``.model``."""
    found = getattr(model, "model", model)
    return found if isinstance(found, Model) else load_model(Path(found))


def as_logs(logs: Logs | None, robot: Robot, *, require_torque: bool = True) -> list[Log]:
    """Logs of a robot, read where they are files, in the robot's order of joints.

    Raises:
        InputError: If a log cannot be used or has other joints than the robot.
    """
    if logs is None:
        return []
    many = [logs] if isinstance(logs, OneLog) else list(logs)
    gains = np.asarray(robot.drive_gain)
    read = [
        log
        if isinstance(log, Log)
        else read_log(log, robot.joints, gains, require_torque=require_torque)
        for log in many
    ]
    for log in read:
        if log.joints != robot.joints:
            raise InputError(
                f"{log.source}: has joints {', '.join(log.joints)}, the robot {robot.name} has "
                f"{', '.join(robot.joints)}; pass joints= to log_from_arrays in the robot's order"
            )
        if require_torque and log.tau is None:
            raise InputError(f"{log.source}: has no torque; pass tau to log_from_arrays")
    return read


def refuse_shared(fitted: Sequence[Log], scored: Sequence[Log]) -> None:
    """Refuse to score on what was fitted.

    Raises:
        InputError: Naming the log that stands on both sides.
    """
    for other in scored:
        refuse_repeated_stretches(other, fitted)
        for one in fitted:
            if np.array_equal(one.t, other.t) and np.array_equal(one.q, other.q):
                raise InputError(
                    f"{other.source}: holds the motion that is fitted; it proves nothing, validate on another"
                )
