"""The command ``diagnose``, from files to files."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from jaxswarm import outputs
from jaxswarm.diagnose.asked_again import doubtful, told_again
from jaxswarm.diagnose.candidates.journal import Journal, fingerprint
from jaxswarm.diagnose.decision.material import find_material
from jaxswarm.diagnose.decision.unexplained import Unexplained, with_smooth_terms
from jaxswarm.diagnose.discovery.discover import Search, discover
from jaxswarm.diagnose.files import Files
from jaxswarm.diagnose.memory import refuse_too_large
from jaxswarm.diagnose.report.html import render
from jaxswarm.diagnose.report.orders import order_evidence, order_pictures
from jaxswarm.diagnose.report.result import to_result
from jaxswarm.diagnose.report.shown import ladder_shown, structure_shown
from jaxswarm.diagnose.report.signals import Signals
from jaxswarm.diagnose.selection.budget import given_budget
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.loose_rest import loose_lines
from jaxswarm.diagnose.selection.outcome import outcome_of
from jaxswarm.diagnose.selection.stepwise import diagnose
from jaxswarm.diagnose.selection.survives import proven
from jaxswarm.diagnose.unfit import undecided_by
from jaxswarm.drawing import Drawing
from jaxswarm.effects.formula import with_values
from jaxswarm.effects.formula_file import law_file, law_name
from jaxswarm.effects.term import parse_terms
from jaxswarm.identify.checks.weak import resting_joints
from jaxswarm.identify.estimation.standing import held_lines, held_shares
from jaxswarm.identify.forward.model import model_text
from jaxswarm.identify.options import consistency_told
from jaxswarm.identify.report.summary import units
from jaxswarm.identify.run import Options, refuse_missing_channels, refuse_undeclarable
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.load import load_robot


def diagnose_files(
    paths: list[Path],
    robot_spec: str,
    declare: str,
    out: Path,
    validation: list[Path] | None = None,
    options: Options | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> dict:
    """Find what a declared model lacks and write the report.

    Args:
        paths: Logs to fit.
        robot_spec: Built-in name, ``.urdf`` or ``.toml``.
        declare: List of declared effects.
        out: Folder for ``diagnosis.json``, ``model.json``, ``report.html`` and pictures.
        validation: Logs to score on; none: blocks of time held out in turn.
        options: Frequencies, seed and budget.
        progress: Called with one line per step.

    Returns:
        The content of ``diagnosis.json``.

    Raises:
        InputError: On anything that cannot be used; nothing is written then.
    """
    options = options or Options()
    budget = given_budget(options.budget)
    robot = load_robot(robot_spec)
    terms = parse_terms(declare, robot.joints)
    refuse_undeclarable(terms)
    outputs.check_folder(out)
    progress("reading logs")
    read = Files(paths, validation or [], options.accept).read(robot, options.filtering)
    refuse_missing_channels(terms, read.all)
    told = read.told({"declare": declare, "robot": robot.name, **vars(options)})
    unfit = undecided_by(read.motions, robot, terms, options.accept)
    if unfit is not None:
        page = {"diagnosis.json": outputs.to_json(unfit | told)}
        outputs.write_results(out, page | {"report.html": render(unfit | told, {})})
        return unfit | told
    refuse_too_large(read.motions)
    doubted, read = doubtful(read.fitted, read.scored), replace(read, fitted=[])  # others are large
    journal = Journal(out, fingerprint(robot, [*read.motions, *read.unseen], terms, options.seed))
    with Drawing() as drawing:
        diagnosis = diagnose(
            robot, terms, read.motions, seed=options.seed, progress=progress, journal=journal,
            other=read.unseen, budget=budget,
        )  # fmt: skip
        unseen = read.prepared_like(diagnosis.final.model.filtering)
        search = None
        if options.discover:
            diagnosis, search = discover(diagnosis, unseen, options.seed, progress)
        shown = order_pictures(drawing, diagnosis, unseen)
        result, left = conclude(diagnosis, unseen, options.seed, progress, search)
        result["reasons"] += resting_joints(read.motions, robot)
        result |= told_again(told, result, doubted, diagnosis.final.model)
        write_report(diagnosis, left, result, drawing, out, progress, search, shown)
    journal.close(done=diagnosis.spent is None)
    return result


def conclude(
    diagnosis: Diagnosis,
    unseen: list[Motion],
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
    search: Search | None = None,
) -> tuple[dict, list[Unexplained]]:
    """What remains after the loop, and everything as ``diagnosis.json`` has it."""
    progress("looking at what remains")
    left = find_material(diagnosis.final, diagnosis.crossfit, seed)
    left = proven(diagnosis.final, left, unseen)
    laws = search.found if search else ()
    result = to_result(outcome_of(diagnosis, left, unseen, laws), search=search)
    result["physical_consistency"] = consistency_told(diagnosis.final)
    logs = diagnosis.final.motions
    result["reasons"] += [*held_lines(held_shares(logs)), *loose_lines(logs)]
    return result, left


def write_report(
    diagnosis: Diagnosis,
    left: list[Unexplained],
    result: dict,
    drawing: Drawing,
    out: Path,
    progress: Callable[[str], None] = lambda text: None,
    search: Search | None = None,
    shown: Signals | None = None,
) -> None:
    """Write ``diagnosis.json``, ``model.json``, ``report.html`` and the pictures, whole or not at all.

    ``drawing`` has the orders of :func:`order_pictures`, ``shown`` is what it gave.
    """
    progress("writing the report")
    final = diagnosis.final
    robot = final.model.robot
    drawing.ask("ladder.png", "loop_plots.ladder", *ladder_shown(result))
    laws = {}
    for one in search.found if search else ():
        term = one.added
        joint, other = (
            robot.joints[term.index],
            None if term.other is None else robot.joints[term.other],
        )
        order_evidence(drawing, f"{law_name(joint)}.png", one, final)
        formula = with_values(term.found_formula, term.values)
        laws[f"{law_name(joint)}.py"] = law_file(formula, joint, other)
    for item in left:
        rows, name = final.regression.log >= 0, robot.joints[item.joint]
        residual, unit = final.fit.residual[rows, item.joint], units(robot)[item.joint]
        told = structure_shown(item, residual, name, unit)
        drawing.ask(f"unexplained_{name}.png", "loop_plots.structure", *told)
    model = model_text(with_smooth_terms(final, left))
    images = drawing.finished()
    outputs.write_results(
        out,
        {
            "diagnosis.json": outputs.to_json(result),
            "model.json": model,
            "report.html": render(result, images, shown, model),
            **images,
            **laws,
        },
    )
