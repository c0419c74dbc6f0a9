"""The command ``identify``, from files to files."""

import hashlib
import os
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import jax
import numpy as np

from jaxswarm import outputs
from jaxswarm.drawing import Drawing
from jaxswarm.effects.term import Term, parameter_bounds, parse_terms
from jaxswarm.errors import InputError
from jaxswarm.identify.checks.check_log import checked
from jaxswarm.identify.checks.weak import refuse_weak
from jaxswarm.identify.estimation.clock_skew import estimate_with_clocks
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.model import save_model, with_linear_values
from jaxswarm.identify.options import Options, check_options, refined
from jaxswarm.identify.report.report import order_pictures, report_of
from jaxswarm.logs import Log, read_log, summarize
from jaxswarm.logs.motion import Filtering, Motion
from jaxswarm.logs.repeated import refuse_repeated_stretches
from jaxswarm.logs.shifted import with_skew_of
from jaxswarm.robot.load import load_robot
from jaxswarm.robot.model import Robot

if TYPE_CHECKING:
    from jaxswarm.identify.estimation.swarm_fit import SwarmFit


def read_motions(
    paths: list[Path],
    robot: Robot,
    filtering: Filtering,
    drive_gain=None,
    accept: Sequence[str] = (),
) -> tuple[list[Log], list[list[Motion]]]:
    """Read logs and prepare their stretches between gaps; the first log's frequencies hold for all.

    Args:
        paths: Logs, each with another content.
        robot: The robot.
        filtering: Frequencies; those that are None come from the first log.
        drive_gain: Torque per current, shape (n,); None: the robot's own.
        accept: Checks whose findings are told only.

    Returns:
        The logs with notes, and the motions of each.
    """
    refuse_repeated(paths)
    gains = np.asarray(robot.drive_gain if drive_gain is None else drive_gain)
    logs: list[Log] = []
    motions: list[list[Motion]] = []
    for path in paths:
        log = read_log(path, robot.joints, gains)
        refuse_repeated_stretches(log, logs)
        log, parts = checked(log, robot, filtering, accept)
        filtering = parts[0].filtering
        logs.append(log)
        motions.append(parts)
    return logs, motions


def findings(logs: list[Log]) -> list[dict]:
    """What was found wrong with the logs themselves."""
    return [{"log": Path(log.source).name, "what": note} for log in logs for note in log.notes]


def described(logs: list[Log]) -> list[dict]:
    """Summaries of logs with their notes, as the results hold them."""
    return [{**summarize(log).to_dict(), "notes": list(log.notes)} for log in logs]


def told_of(fitted: Sequence[Log], scored: Sequence[Log]) -> dict:
    """What a result says of the logs it was fitted to and of those it is scored on."""
    return {
        "logs": described([*fitted]),
        "validation_logs": described([*scored]),
        "findings": findings([*fitted, *scored]),
    }


def refuse_repeated(paths: list[Path]) -> None:
    """Refuse the same content twice, of files or of recordings that are folders: no twice the evidence.

    Raises:
        InputError: Naming both files.
    """
    named = []
    for path in paths:
        if not os.path.exists(path):  # nor a name that no file system takes
            continue
        inside = sorted(Path(path).rglob("*")) if os.path.isdir(path) else [Path(path)]
        parts = [part for part in inside if part.is_file()]
        named.append((path, parts, sum(part.stat().st_size for part in parts)))
    sizes = Counter(size for _, _, size in named)
    seen: dict[str, Path] = {}
    for path, parts, size in named:
        if sizes[size] == 1:  # no other can be the same, and a hash of gigabytes takes a minute
            continue
        content = hashlib.sha256()
        for part in parts:
            with open(part, "rb") as file:
                content.update(hashlib.file_digest(file, "sha256").digest())
        digest = content.hexdigest()
        if digest in seen:
            raise InputError(
                f"{path}: holds the same as {seen[digest]}; the same motion twice is no second "
                "proof, name every log once and score on another one"
            )
        seen[digest] = path


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


def refuse_undeclarable(terms: tuple[Term, ...]) -> None:
    """Refuse terms that one fit to whole logs cannot hold."""
    for term in terms:
        if term.law.reference_only:
            raise InputError(
                f"{term.effect} cannot be declared: in a fit to whole logs nothing tells it from the "
                "arm. Leave it out; jaxswarm diagnose finds what happened once, and with --model "
                "what changed since an earlier model, such as a load on the last link"
            )


def refuse_missing_channels(terms: tuple[Term, ...], logs: list[Log]) -> None:
    """Refuse logs without the channel that a declared law needs on its joint."""
    needed = [(term, name, log) for term in terms for name in term.law.requires for log in logs]
    for term, name, log in needed:
        values = log.channels.get(name)
        # A channel without a joint has one column for all, which no law reads.
        own = values[:, term.index] if values is not None and values.ndim == 2 else None
        if own is None or not np.isfinite(own).all():
            joint = log.joints[term.index]
            raise InputError(
                f"{log.source}: {term.effect} on {joint} needs the channel {name}_{joint} in every "
                f"log, complete; log it, or leave {term.effect} out"
            )


def identify_files(
    paths: list[Path],
    robot_spec: str,
    effects: str,
    out: Path,
    validation: Path | None = None,
    options: Options | None = None,
    progress=lambda text: None,
    settled: Callable[[Estimate], Estimate] = lambda found: found,
) -> dict:
    """Identify from log files and write ``model.json``, ``identification.json`` and pictures.

    Args:
        paths: Logs to fit.
        robot_spec: Built-in name, ``.urdf`` or ``.toml``.
        effects: List of declared effects.
        out: Folder to write to.
        validation: Log to score on; None: blocks of time held out in turn.
        options, progress: See :class:`Options`; called with one line before each step.
        settled: Gives the fit that is told, such as one without rows in which friction holds joints.

    Returns:
        The content of ``identification.json``.

    Raises:
        InputError: On anything that cannot be used; nothing is written then.
    """
    options, robot = options or Options(), load_robot(robot_spec)
    terms = parse_terms(effects, robot.joints)
    check_options(options)
    refuse_undeclarable(terms)
    outputs.check_folder(out)
    with Drawing() as drawing:
        progress("reading logs")
        files = paths if validation is None else [*paths, validation]
        read, motions = read_motions(files, robot, options.filtering, accept=options.accept)
        unseen = None if validation is None else motions.pop()
        logs, fitted = read[: len(paths)], [part for parts in motions for part in parts]
        refuse_resting_joints(logs, robot)
        refuse_weak(fitted, 10 * robot.num_joints, options.accept)
        refuse_missing_channels(terms, read)
        told = {"findings": findings(read), "validation_logs": described(read[len(paths) :])}
        summaries = described(logs)
        # A long log is as large as all that is made of it, and its samples are not asked for again.
        del read, logs, motions
        progress("fitting")
        found = settled(estimate_with_clocks(robot, terms, fitted))
        if unseen is not None:
            unseen = [with_skew_of(part, found.motions[0]) for part in unseen]
        found, search = _searched(found, options, progress)
        found, estimator, bodies = refined(found, options, progress)
        order_pictures(drawing, found, max(unseen or found.motions, key=lambda m: len(m.t)), search)
        progress("scoring")
        report = report_of(found, summaries, unseen, validation, search) | told
        report |= {"estimator": estimator, "physical_consistency": bodies}
        progress("writing")
        content: dict[str, outputs.Content] = {"identification.json": outputs.to_json(report)}
        content["model.json"] = lambda path: save_model(found.model, path)
        outputs.write_results(out, content | drawing.finished())
    return report


def _searched(found: Estimate, options: Options, progress) -> "tuple[Estimate, SwarmFit | None]":
    """The estimate with what a swarm finds, where one is asked for, and its search."""
    if options.optimizer == "least_squares":
        return found, None
    progress(f"searching with {options.optimizer}")
    # The engine is loaded for those who ask for it.
    from jaxswarm.identify.estimation.swarm_fit import swarm_fit

    lower, upper = parameter_bounds(found.model.terms, found.model.robot.joints)
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
    return with_values(found, search.values), search


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
