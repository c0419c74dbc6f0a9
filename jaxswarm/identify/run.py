"""The command ``identify``, from files to files."""

from dataclasses import dataclass, replace
from pathlib import Path

import jax
import numpy as np

from jaxswarm import outputs
from jaxswarm.effects.term import parameter_bounds, parse_terms
from jaxswarm.errors import InputError
from jaxswarm.identify.estimation.estimate import Estimate, estimate
from jaxswarm.identify.estimation.swarm_fit import swarm_fit
from jaxswarm.identify.forward.model import save_model, with_linear_values
from jaxswarm.identify.report.report import pictures_of, report_of
from jaxswarm.logs import Log, read_log, summarize
from jaxswarm.logs.motion import Filtering, prepare
from jaxswarm.robot.load import load_robot
from jaxswarm.robot.model import Robot
from jaxswarm.swarm import find_optimizer


@dataclass(frozen=True)
class Options:
    """How to identify; the fields are the options of the command line."""

    optimizer: str = "least_squares"
    runs: int = 10
    steps: int = 500
    whiten: bool = True
    seed: int = 0
    motion_cutoff: float | None = None
    torque_cutoff: float | None = None


def read_motions(paths: list[Path], robot: Robot, filtering: Filtering) -> tuple[list, list]:
    """Read and prepare training logs; the first log's frequencies hold for all of them."""
    logs, motions = [], []
    for path in paths:
        log = read_log(path, robot.joints, np.asarray(robot.drive_gain))
        motion = prepare(log, filtering)
        filtering = motion.filtering
        logs.append(log)
        motions.append(motion)
    return logs, motions


def refuse_resting_joints(logs: list[Log], robot: Robot) -> None:
    """Refuse logs in which a joint never moves, naming what that leaves unidentified."""
    summaries = [summarize(log) for log in logs]
    for j, joint in enumerate(robot.joints):
        if not any(s.joints[j].moves for s in summaries):
            raise InputError(
                f"{logs[0].source}: {joint} never moves, so its friction and rotor inertia and the "
                f"inertia of link {j + 1} about its own axis (I..{j + 1}, and what merges into them) "
                f"cannot be identified; excite {joint} in the log (jaxswarm excite makes a motion)"
            )


def identify_files(
    paths: list[Path],
    robot_spec: str,
    effects: str,
    out: Path,
    validation: Path | None = None,
    options: Options | None = None,
    progress=lambda text: None,
) -> dict:
    """Identify from log files and write ``model.json``, ``identification.json`` and pictures.

    Args:
        paths: Logs to fit.
        robot_spec: Built-in name, ``.urdf`` or ``.toml``.
        effects: List of declared effects.
        out: Folder to write to.
        validation: Log to score on; None: blocks of time held out in turn.
        options: See :class:`Options`.
        progress: Called with one line before each stage.

    Returns:
        The content of ``identification.json``.

    Raises:
        InputError: On anything that cannot be used; nothing is written then.
    """
    options = options or Options()
    robot = load_robot(robot_spec)
    terms = parse_terms(effects, robot.joints)
    if options.optimizer != "least_squares":
        find_optimizer(options.optimizer)
    outputs.check_folder(out)
    progress("reading logs")
    logs, motions = read_motions(
        paths, robot, Filtering(options.motion_cutoff, options.torque_cutoff)
    )
    refuse_resting_joints(logs, robot)
    unseen = None
    if validation is not None:
        filtering = motions[0].filtering
        unseen = prepare(
            read_log(validation, robot.joints, np.asarray(robot.drive_gain)), filtering
        )
    progress("fitting")
    found = estimate(robot, terms, motions)
    search = None
    if options.optimizer != "least_squares":
        progress(f"searching with {options.optimizer}")
        lower, upper = parameter_bounds(found.model.terms, robot.joints)
        search = swarm_fit(
            found.fit,
            options.optimizer,
            jax.random.key(options.seed),
            runs=options.runs,
            num_steps=options.steps,
            whiten=options.whiten,
            lower=lower,
            upper=upper,
        )
        found = with_values(found, search.values)
    progress("scoring")
    report = report_of(found, logs, unseen, validation, search)
    progress("writing")
    outputs.write_files(
        out,
        {
            "model.json": lambda path: save_model(found.model, path),
            "identification.json": outputs.to_json(report),
            **pictures_of(found, unseen or found.motions[0], search),
        },
    )
    return report


def with_values(found: Estimate, values: np.ndarray) -> Estimate:
    """The same estimate with other base parameter values, such as a swarm's."""
    solution = replace(
        found.fit,
        values=values,
        residual=found.regression.target
        - found.regression.columns[:, :, found.fit.base.kept] @ values,
    )
    model = with_linear_values(found.model, solution.theta)
    return replace(found, fit=solution, model=model)
