"""Plan a motion on which the parameters can be told apart best."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from jaxswarm.effects.friction import USUAL_FRICTION
from jaxswarm.effects.term import parse_terms
from jaxswarm.identify.excitation.columns import refuse_terms
from jaxswarm.identify.excitation.limits import parse_limits, read_limits
from jaxswarm.identify.excitation.search import excite as search
from jaxswarm.identify.excite_run import schedule
from jaxswarm.logs import Log
from jaxswarm.robot import Robot
from jaxswarm.tables import Result, Table
from jaxswarm.tasks.inputs import as_robot, in_double
from jaxswarm.tasks.words import number


@dataclass(frozen=True, eq=False, repr=False)
class Planned(Result):
    """A planned motion; ``log`` has t, q, dq and ddq at the rate of the limits."""

    log: Log | None = None


@in_double
def excite(
    robot: Robot | str | Path,
    limits: Mapping[str, Any] | str | Path,
    effects: str = USUAL_FRICTION,
    *,
    duration: float | None = None,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
) -> Planned:
    """Search the periodic motion within limits with the smallest condition number.

    Args:
        robot: A robot, a built-in name or a file; kinematics suffice.
        limits: A limits file, or its content: for each joint ``position`` (two numbers), ``velocity``
            and ``acceleration``, in rad or m.
        effects: What will be identified besides the rigid body.
        duration: Length [s]; None: one period.
        seed: Seed of the search.
        progress: Called with one line per stage.

    Raises:
        InputError: On anything that cannot be used.
    """
    robot = as_robot(robot)
    terms = parse_terms(effects, robot.joints)
    refuse_terms(terms, robot.joints)
    if isinstance(limits, Mapping):
        bounds = parse_limits(dict(limits), robot.joints)
    else:
        bounds = read_limits(limits, robot.joints)
    periods, samples = schedule(bounds, duration)
    bounds = replace(bounds, fundamental=bounds.rate / samples)
    found = search(robot, terms, bounds, bounds.fundamental, seed=seed, progress=progress)
    t = np.arange(periods * samples + 1) / bounds.rate
    log = Log(f"planned: {robot.name}", robot.joints, t, *found.trajectory.motion(t))
    numbers = {
        "before": float(found.random[0]),
        "after": float(found.condition),
        "random_median": float(np.median(found.random)),
        "random_best": float(found.random.min()),
    }
    content = {
        "robot": robot.name,
        "duration": float(t[-1]),
        "rate": bounds.rate,
        "condition_number": numbers,
        "base_parameters": list(found.base.expressions()),
    }
    rows = tuple((name.replace("_", " "), number(value, 4)) for name, value in numbers.items())
    table = Table(f"{robot.name}: {t[-1]:.6g} s", ("condition number", ""), rows)
    return Planned(content, (), (table,), log=log)
