"""``diagnose --model``: what changed since a model was identified, from files to files."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from jaxswarm import outputs
from jaxswarm.diagnose.against import Change, Comparison, compare
from jaxswarm.diagnose.journal import Journal, fingerprint
from jaxswarm.diagnose.loop import Diagnosis
from jaxswarm.diagnose.result import place, to_result
from jaxswarm.diagnose.run import write_report
from jaxswarm.diagnose.step import Step
from jaxswarm.diagnose.unexplained import find_unexplained
from jaxswarm.errors import InputError
from jaxswarm.identify.metrics import torque_errors
from jaxswarm.identify.model import load_model
from jaxswarm.identify.run import Options, described, read_motions, refuse_missing_channels
from jaxswarm.identify.summary import term_parameters, with_intervals
from jaxswarm.robot.load import load_robot


def compare_files(
    paths: list[Path],
    robot_spec: str,
    model_path: Path,
    out: Path,
    validation: list[Path] | None = None,
    options: Options | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> dict:
    """Find what changed since a model was identified and write the report.

    Args:
        paths: New logs of the same robot.
        robot_spec: The robot; it has to be the model's.
        model_path: ``model.json`` of identify or diagnose.
        out: Folder for ``diagnosis.json``, ``model.json``, ``report.html`` and pictures.
        validation: Further new logs to score on.
        options: Seed.
        progress: Called with one line per stage.

    Returns:
        The content of ``diagnosis.json``.

    Raises:
        InputError: On anything that cannot be used; nothing is written then.
    """
    options = options or Options()
    model = load_model(model_path)
    robot = load_robot(robot_spec)
    if (robot.joints, robot.kinds) != (model.robot.joints, model.robot.kinds):
        raise InputError(
            f"{model_path}: is a model of {model.robot.name} with joints "
            f"{', '.join(model.robot.joints)}, not of {robot.name} with {', '.join(robot.joints)}; "
            "pass the robot it was identified for"
        )
    outputs.check_folder(out)
    progress("reading logs")
    further = list(validation or ())
    gains = np.asarray(model.robot.drive_gain)
    read, prepared = read_motions([*paths, *further], robot, model.filtering, gains)
    refuse_missing_channels(model.terms, read)
    motions = [part for parts in prepared[: len(paths)] for part in parts]
    unseen = [part for parts in prepared[len(paths) :] for part in parts]
    text = Path(model_path).read_text(encoding="utf-8")
    journal = Journal(out, fingerprint(robot, motions, text, options.seed))
    found = compare(model, motions, seed=options.seed, progress=progress, journal=journal)
    result, diagnosis, left = conclude_comparison(found, unseen, options.seed, progress)
    result["model"] = str(model_path)
    result["logs"] = described(read[: len(paths)])
    result["validation_logs"] = described(read[len(paths) :])
    write_report(diagnosis, left, result, unseen, out, progress)
    journal.close()
    return result


def conclude_comparison(found: Comparison, unseen, seed: int, progress=lambda text: None):
    """The comparison as ``diagnosis.json`` has it, as a diagnosis for the pictures, and what remains."""
    progress("looking at what remains")
    diagnosis = _as_diagnosis(found)
    left = find_unexplained(found.after, found.background, seed)
    result = to_result(diagnosis, left, unseen)
    joints = found.before.model.robot.joints
    kinds = found.before.model.robot.kinds
    for entry, change in zip(result["effects"], found.changes, strict=True):
        kind = "revolute" if change.term.joint is None else kinds[change.term.joint]
        entry["parameters"] = _parameters(change, kind)
        entry["change_of_known"] = change.known
    measured, moving = found.before.regression.torque, found.before.regression.moving
    if not unseen:
        before = _errors(measured, found.before.fit.residual, moving)
        stages = [_errors(measured, r, moving) for r in found.unseen]
        result["error"]["before"] = before
        result["error"]["after"] = stages[-1] if stages else before
        for step, one, other in zip(result["steps"], [before, *stages], stages, strict=False):
            step["before"], step["after"] = one, other
    result["declared"] = [place(t, joints) for t in found.before.model.terms]
    return result, diagnosis, left


def _errors(measured: np.ndarray, residual: np.ndarray, moving: np.ndarray) -> dict:
    errors = torque_errors(measured, measured - residual, moving)
    return {**errors, "on": "blocks of the new log the changes were not fitted to"}


def _parameters(change: Change, kind: str) -> dict:
    term = change.term
    if set(term.values) >= {p.name for p in term.law.parameters}:
        table = term_parameters(term, kind, change.std_errors)
    else:
        missing = {p.name: 0.0 for p in term.law.parameters}
        table = term_parameters(
            replace(term, values={**missing, **term.values}), kind, change.std_errors
        )
    return with_intervals(table)


def _as_diagnosis(found: Comparison) -> Diagnosis:
    """The same outcome in the shape the report knows."""
    before = (found.before, *found.stages)
    steps = tuple(
        Step(change.term, change.score, (), change.others, one, other, ())
        for change, one, other in zip(found.changes, before, found.stages, strict=False)
    )
    return Diagnosis(found.before, found.after, steps, found.last, found.background, found.asked)
