"""Plan a motion on which the parameters can be told apart best."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jaxswarm.identify.excitation.limits import parse_limits, read_limits
from jaxswarm.identify.excite_plan import plan_motion
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs import Log
from jaxswarm.robot import Robot, describe_robot
from jaxswarm.tables import Result, Table
from jaxswarm.tasks.inputs import as_model, as_robot, in_double
from jaxswarm.tasks.words import number


@dataclass(frozen=True, eq=False, repr=False)
class Planned(Result):
    """A planned motion; ``log`` has t, q, dq and ddq at the rate of the limits."""

    log: Log | None = None


@in_double
def excite(
    robot: Robot | str | Path,
    limits: Mapping[str, Any] | str | Path,
    effects: str | None = None,
    *,
    duration: float | None = None,
    seed: int = 0,
    separate: str | None = None,
    given: Model | str | Path | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> Planned:
    """Search the periodic motion within limits with the smallest condition number.

    Args:
        robot: A robot, a built-in name or a file; kinematics suffice.
        limits: A limits file, or its content: for each joint ``position`` (two numbers), ``velocity``
            and ``acceleration``, in rad or m, and optionally ``effort``, in N m or N; ``radius`` and
            ``distance`` of links, in m.
        effects: What will be identified besides the rigid body; None: viscous and dry friction.
        duration: Length [s]; None: one period.
        seed: Seed of the search.
        separate: Two effects, ``effect@joint,effect@joint``: search the motion that best tells these apart.
        given: A model, or its file: its masses and effects say what torque a motion needs, and ``separate``
            takes them for granted.
        progress: Called with one line per stage.

    Raises:
        InputError: On anything that cannot be used.
    """
    described = None if isinstance(robot, Robot) else describe_robot(robot)
    robot = as_robot(robot)
    if isinstance(limits, Mapping):
        bounds = parse_limits(dict(limits), robot.joints)
    else:
        bounds = read_limits(limits, robot.joints)
    model = None if given is None else as_model(given)
    plan, content = plan_motion(
        robot, bounds, effects, duration, seed, progress, separate=separate, given=model,
        description=described,
    )  # fmt: skip
    log = Log(f"planned: {robot.name}", robot.joints, plan.t, *plan.motion)
    numbers = content["condition_number"]
    rows = tuple((name.replace("_", " "), number(value, 4)) for name, value in numbers.items())
    title = f"{robot.name}: {plan.t[-1]:.6g} s"
    tables = [Table(title, ("condition number", ""), rows)]
    if separate is not None:
        apart = content["separation"]
        rows = tuple((name, number(apart[name], 4)) for name in ("ordinary", "reached", "ratio"))
        tables.append(Table(" and ".join(apart["effects"]), ("separation", ""), rows))
    return Planned(content, tuple(content["notes"]), tuple(tables), log=log)
