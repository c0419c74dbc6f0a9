"""``diagnose --model``: what changed since a model was identified, from files to files."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from jaxswarm import cores, outputs
from jaxswarm.diagnose.asked_again import doubtful, told_again
from jaxswarm.diagnose.candidates.journal import Journal, fingerprint
from jaxswarm.diagnose.decision.material import find_material
from jaxswarm.diagnose.files import Files
from jaxswarm.diagnose.memory import refuse_too_large
from jaxswarm.diagnose.report.orders import order_pictures
from jaxswarm.diagnose.report.place import place
from jaxswarm.diagnose.report.result import to_result
from jaxswarm.diagnose.run import write_report
from jaxswarm.diagnose.selection.budget import given_budget
from jaxswarm.diagnose.selection.change_apply import Change, with_changes
from jaxswarm.diagnose.selection.changes import Comparison, compare
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.outcome import outcome_of
from jaxswarm.diagnose.selection.step import Step
from jaxswarm.diagnose.selection.survives import proven
from jaxswarm.drawing import Drawing
from jaxswarm.errors import InputError
from jaxswarm.identify.checks.weak import refuse_weak
from jaxswarm.identify.forward.event_rows import event_rows
from jaxswarm.identify.forward.metrics import torque_errors
from jaxswarm.identify.forward.model import Model, load_model
from jaxswarm.identify.options import consistency_told
from jaxswarm.identify.report.summary import term_parameters, with_intervals
from jaxswarm.identify.run import Options, refuse_missing_channels, refuse_resting_joints
from jaxswarm.robot.load import load_robot
from jaxswarm.robot.model import Robot


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
    budget = given_budget(options.budget)
    model, robot = _same_arm(model_path, robot_spec)
    outputs.check_folder(out)
    progress("reading logs")
    gains = np.asarray(model.robot.drive_gain)
    read = Files(paths, validation or [], options.accept).read(robot, model.filtering, gains)
    refuse_missing_channels(model.terms, read.all)
    refuse_resting_joints(read.fitted, robot)
    refuse_weak(read.motions, 10 * robot.num_joints, options.accept)
    refuse_too_large(read.motions)
    told = read.told({"robot": robot.name, **vars(options)}, model_path)
    text = Path(model_path).read_text(encoding="utf-8")
    journal = Journal(out, fingerprint(robot, read.motions, text, options.seed))
    with Drawing() as drawing:
        found = compare(
            model,
            read.motions,
            seed=options.seed,
            progress=progress,
            journal=journal,
            budget=budget,
        )
        result, diagnosis, left = conclude_comparison(found, read.unseen, options.seed, progress)
        shown = order_pictures(drawing, diagnosis, read.unseen)
        told = told_again(told, result, doubtful(read.fitted, read.scored), found.after.model)
        result |= {"model": Path(model_path).name, **told}
        write_report(diagnosis, left, result, drawing, out, progress, shown=shown)
    journal.close(done=found.spent is None)
    return result


def _same_arm(model_path: Path, robot_spec: str) -> tuple[Model, Robot]:
    """A model and the robot it has to be of."""
    model, robot = load_model(model_path), load_robot(robot_spec)
    if (robot.joints, robot.kinds) != (model.robot.joints, model.robot.kinds):
        raise InputError(
            f"{model_path}: is a model of {model.robot.name} with joints "
            f"{', '.join(model.robot.joints)}, not of {robot.name} with {', '.join(robot.joints)}; "
            "pass the robot it was identified for"
        )
    return model, robot


def conclude_comparison(found: Comparison, unseen, seed: int, progress=lambda text: None):
    """The comparison as ``diagnosis.json`` has it, as a diagnosis for the pictures, and what remains."""
    progress("looking at what remains")
    diagnosis = _as_diagnosis(found)
    with cores.beside(lambda: consistency_told(found.after)) as bodies:
        left = proven(found.after, find_material(found.after, found.crossfit, seed), unseen)
        result = to_result(outcome_of(diagnosis, left, unseen))
        result["physical_consistency"] = bodies()
    robot = found.before.model.robot
    for entry, change in zip(result["effects"], found.changes, strict=True):
        entry["parameters"] = _parameters(change, robot)
        if change.term.law.way is not None:
            entry["way"] = change.term.law.way(change.term.values)
    pairs = list(zip(result["effects"], found.changes, strict=True))
    result["effects"] = [entry for entry, change in pairs if not change.known]
    result["changed"] = [entry for entry, change in pairs if change.known]
    result["reasons"] += _reasons(found)
    measured, moving = found.before.regression.torque, found.before.regression.moving
    if not unseen:
        before = _errors(measured, found.before.fit.residual, moving)
        after_each = [
            _errors(measured[used], left[used], moving[used])
            for left, used in zip(found.unseen, _rows_used(found), strict=True)
        ]
        result["error"]["before"] = before
        result["error"]["after"] = after_each[-1] if after_each else before
        for step, one, other in zip(
            result["steps"], [before, *after_each], after_each, strict=False
        ):
            step["before"], step["after"] = one, other
    result["declared"] = [place(t, robot.joints) for t in found.before.model.terms]
    return result, diagnosis, left


def _rows_used(found: Comparison) -> Iterator[np.ndarray]:
    """The rows (T,) that the model with each further change is held against: those of no event it has."""
    terms = [change.term for change in found.changes]
    for count in range(1, len(terms) + 1):
        within = [event_rows(terms[:count], m, k) for k, m in enumerate(found.before.motions)]
        yield ~np.concatenate(within)


def _errors(measured: np.ndarray, residual: np.ndarray, moving: np.ndarray) -> dict:
    errors = torque_errors(measured, measured - residual, moving)
    return {**errors, "on": "blocks of the new log the changes were not fitted to"}


def _parameters(change: Change, robot: Robot) -> dict:
    """Values with intervals; of what was known the present ones, with the earlier ones and the change."""
    term = change.term
    missing = {p.name: 0.0 for p in term.law.parameters}
    moved = replace(term, values={**missing, **term.values})
    told = with_intervals(term_parameters(moved, robot, change.std_errors))
    if not change.known:
        return told
    now = replace(term, values={**moved.values, **change.now})
    table = with_intervals(term_parameters(now, robot, change.now_errors))
    for name in change.std_errors:
        table[name]["before"] = change.now[name] - term.values[name]
        table[name]["change"] = told[name]
    return table


def _reasons(found: Comparison) -> list[str]:
    """What a reader of the intervals, and of what is missing among the changes, has to know."""
    joints = found.before.model.robot.joints
    told = [f"{term.label(joints)} {why}; it was not added" for term, why in found.refused]
    if found.changes and found.before.model.uncertainty is None:
        told.append(
            "the earlier model tells no covariance of its parameters, so the intervals do not carry its "
            "uncertainty: identify it again"
        )
    return told


def _as_diagnosis(found: Comparison) -> Diagnosis:
    """The same outcome in the shape the report knows."""
    before = (found.before, *found.after_each)
    steps = []
    for k, (one, other) in enumerate(zip(before, found.after_each, strict=False)):
        change = found.changes[k]
        rest = with_changes(found.before, found.changes[:k] + found.changes[k + 1 :])
        steps.append(Step(change.term, change.score, (), change.others, one, other, (), rest=rest))
    return Diagnosis(
        found.before, found.after, tuple(steps), found.last, found.crossfit, found.asked,
        rules=found.rules, spent=found.spent,
    )  # fmt: skip
