"""The commands ``identify`` and ``predict``, from files to files."""

from dataclasses import dataclass, replace
from pathlib import Path

import jax
import numpy as np

from jaxswarm import outputs, plots
from jaxswarm.errors import InputError
from jaxswarm.identify.estimate import Estimate, estimate
from jaxswarm.identify.model import Model, load_model, model_torque, save_model
from jaxswarm.identify.summary import (
    base_parameter_table,
    correlation,
    term_parameters,
    unidentified,
    units,
)
from jaxswarm.identify.swarm_fit import SwarmFit, swarm_fit
from jaxswarm.identify.terms import parameter_bounds, parse_terms
from jaxswarm.identify.validate import held_out_errors, log_errors
from jaxswarm.logs import Log, read_log, summarize
from jaxswarm.logs.motion import Filtering, Motion, prepare
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
        filtering = Filtering(motion.motion_cutoff, motion.torque_cutoff)
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
        filtering = Filtering(motions[0].motion_cutoff, motions[0].torque_cutoff)
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
    report = _report(found, logs, unseen, validation, search)
    progress("writing")
    outputs.write_files(
        out,
        {
            "model.json": lambda path: save_model(found.model, path),
            "identification.json": outputs.to_json(report),
            **_pictures(found, unseen or found.motions[0], search),
        },
    )
    return report


def with_values(found: Estimate, values: np.ndarray) -> Estimate:
    """The same estimate with other base parameter values, such as a swarm's."""
    solution = replace(
        found.fit,
        values=values,
        residual=found.regression.torque
        - found.regression.columns[:, :, found.fit.base.kept] @ values,
    )
    theta, robot = solution.theta, found.model.robot
    rigid, terms = 10 * robot.num_joints, []
    k = rigid
    for term in found.model.terms:
        changed = dict(term.values)
        for p in term.law.linear:
            changed[p.name] = float(theta[k])
            k += 1
        terms.append(replace(term, values=changed))
    pi = theta[:rigid]
    model = replace(
        found.model, robot=robot.replace(parameters=pi.reshape(-1, 10)), terms=tuple(terms)
    )
    return replace(found, fit=solution, model=model)


def predict_file(model_path: Path, log_path: Path, out: Path) -> dict:
    """Predict the torque along a log at its own time stamps and write it as CSV.

    Raises:
        InputError: If the model or the log cannot be used, or the file not be written.
    """
    model = load_model(model_path)
    out = Path(out)
    outputs.check_folder(out.parent)
    if out.is_dir():
        raise InputError(f"--out {out}: is a folder; name a file such as {out / 'pred.csv'}")
    robot = model.robot
    log = read_log(log_path, robot.joints, np.asarray(robot.drive_gain), require_torque=False)
    t, tau, motion = predict_log(model, log)
    header = ",".join(["t", *(f"tau_{j}" for j in robot.joints)])
    table = np.column_stack([t, tau])

    def write(path: Path) -> None:
        np.savetxt(path, table, delimiter=",", header=header, comments="", fmt="%.10g")

    outputs.write_files(out.parent, {out.name: write})
    result = {"log": str(log_path), "samples": len(t), "out": str(out)}
    if motion.tau is not None:
        result["error"] = log_errors(model, motion)
    return result


def predict_log(model: Model, log: Log) -> tuple[np.ndarray, np.ndarray, Motion]:
    """Torque of a model at a log's own time stamps: times (T,), torque (T, n), and the motion used."""
    motion = prepare(log, model.filtering)
    torque = model_torque(model, motion)
    own = log.t - log.t[0]
    columns = [np.interp(own, motion.t, torque[:, j]) for j in range(torque.shape[1])]
    return log.t, np.column_stack(columns), motion


def _report(found: Estimate, logs, unseen, validation, search: SwarmFit | None) -> dict:
    model, solution = found.model, found.fit
    robot = model.robot
    train = [log_errors(model, motion) for motion in found.motions]
    report = {
        "robot": robot.name,
        "joints": list(robot.joints),
        "effects": [
            {
                "effect": t.effect,
                "joint": None if t.joint is None else robot.joints[t.joint],
                "other": None if t.other is None else robot.joints[t.other],
                "parameters": term_parameters(
                    t,
                    "revolute" if t.joint is None else robot.kinds[t.joint],
                    errors,
                ),
            }
            for t, errors in zip(model.terms, found.std_errors, strict=True)
        ],
        "base_parameters": base_parameter_table(found),
        "not_identifiable": unidentified(found),
        "condition_number": solution.condition,
        "correlation": correlation(found),
        "effective_samples": solution.effective_samples,
        "sign_width": model.width,
        "filtering": {
            "motion_cutoff_hz": found.motions[0].motion_cutoff,
            "torque_cutoff_hz": found.motions[0].torque_cutoff,
        },
        "residual_std": solution.sigma,
        "torque_units": units(robot),
        "logs": [{**summarize(log).to_dict(), "notes": log.notes} for log in logs],
        "error": {
            "train": train[0] if len(train) == 1 else train,
            "held_out_blocks": held_out_errors(found),
            "validation": None if unseen is None else log_errors(model, unseen),
            "validation_log": None if validation is None else str(validation),
        },
        "optimizer": {"name": "least_squares", "cost": solution.cost},
    }
    if search is not None:
        report["optimizer"] = {
            "name": search.optimizer,
            "whiten": search.whiten,
            "runs": len(search.costs),
            "evaluations": search.evaluations,
            "cost": {"best": search.costs.min(), "median": float(np.median(search.costs))},
            "least_squares_cost": search.optimum,
            "excess_over_least_squares": {
                "best": search.excess.min(),
                "median": float(np.median(search.excess)),
            },
            "optimum_outside_box": search.outside,
        }
    return report


def _pictures(found: Estimate, motion: Motion, search: SwarmFit | None) -> dict:
    robot = found.model.robot
    low = motion.decimator
    kept = low.kept(len(motion.t))
    measured, predicted = low.apply(motion.tau), low.apply(model_torque(found.model, motion))
    labels = units(robot)
    load = low.apply(motion.tau) - 0.0
    pictures = {
        "torque.png": plots.png(
            plots.torque_overlay(
                motion.t[kept],
                measured,
                predicted,
                robot.joints,
                labels,
                f"{robot.name}: torque below {motion.torque_cutoff:.3g} Hz, {Path(motion.source).name}",
            )
        ),  # fmt: skip
        "residual.png": plots.png(
            plots.residual_dependence(
                measured - predicted,
                {
                    "q": motion.q[kept],
                    "dq": motion.dq[kept],
                    "ddq": motion.ddq[kept],
                    "torque": load,
                    "time [s]": motion.t[kept],
                },
                robot.joints,
                labels,
                f"{robot.name}: what the model leaves",
            )
        ),
    }
    if search is not None:
        pictures["convergence.png"] = plots.png(
            plots.convergence(
                {search.optimizer: search.history},
                search.optimum,
                f"{search.optimizer}: {len(search.costs)} runs against least squares",
            )
        )
    return pictures
