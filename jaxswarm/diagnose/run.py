"""The command ``diagnose``, from files to files."""

import importlib
from collections.abc import Callable
from pathlib import Path

from jaxswarm import outputs
from jaxswarm.diagnose.candidates.journal import Journal, fingerprint
from jaxswarm.diagnose.decision.insufficient import undecidable
from jaxswarm.diagnose.decision.remainder import material, remainders
from jaxswarm.diagnose.decision.unexplained import Unexplained, find_unexplained, with_smooth_terms
from jaxswarm.diagnose.discovery.discover import Search, discover
from jaxswarm.diagnose.memory import refuse_too_large
from jaxswarm.diagnose.report.html import render
from jaxswarm.diagnose.report.orders import order_pictures
from jaxswarm.diagnose.report.result import place, to_result
from jaxswarm.diagnose.report.signals import Signals
from jaxswarm.diagnose.selection.budget import given_budget
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.stepwise import diagnose
from jaxswarm.diagnose.selection.survives import proven
from jaxswarm.drawing import Drawing
from jaxswarm.effects.formula import with_values
from jaxswarm.effects.formula_file import law_file, law_name
from jaxswarm.effects.term import parse_terms
from jaxswarm.identify.checks.check_log import without_relation
from jaxswarm.identify.checks.weak import WEAK, all_rest, resting_joints, too_short
from jaxswarm.identify.forward.model import save_model
from jaxswarm.identify.options import consistency_told
from jaxswarm.identify.report.summary import units
from jaxswarm.identify.run import (
    Options,
    described,
    findings,
    read_motions,
    refuse_missing_channels,
    refuse_undeclarable,
)
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import Filtering, Motion
from jaxswarm.logs.segments import prepare_segments
from jaxswarm.provenance import provenance
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
        progress: Called with one line per stage.

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
    filtering = Filtering(options.motion_cutoff, options.torque_cutoff)
    further = list(validation or ())
    # What cannot be scored on is refused before the work, not after it.
    read, prepared = read_motions([*paths, *further], robot, filtering, accept=options.accept)
    logs, scored = read[: len(paths)], read[len(paths) :]
    refuse_missing_channels(terms, read)
    motions = [part for parts in prepared[: len(paths)] for part in parts]
    reasons = resting_joints(motions, robot)
    columns = 10 * robot.num_joints + sum(len(t.columns(robot.joints)) for t in terms)
    weak = WEAK not in options.accept
    short = too_short(motions, columns) if weak else []
    rests = all_rest(motions)
    if not rests and "no_relation" not in options.accept:
        rests = without_relation(robot, motions)
    if short or rests:
        declared = [place(t, robot.joints) for t in terms]
        result = undecidable(robot, declared, units(robot), [*rests, *short, *reasons])
        _tell_source(result, logs, scored, [*paths, *further], declare, options)
        page = {"diagnosis.json": outputs.to_json(result), "report.html": render(result, {})}
        outputs.write_results(out, page)
        return result
    refuse_too_large(motions)
    other = [part for parts in prepared[len(paths) :] for part in parts]
    journal = Journal(out, fingerprint(robot, [*motions, *other], terms, options.seed))
    with Drawing() as drawing:
        diagnosis = diagnose(
            robot, terms, motions, seed=options.seed, progress=progress, journal=journal,
            other=other, budget=budget,
        )  # fmt: skip
        band = diagnosis.final.model.filtering
        unseen = [part for log in scored for part in prepare_segments(log, band)[1]]
        search = None
        if options.discover:
            diagnosis, search = discover(diagnosis, unseen, options.seed, progress)
        shown = order_pictures(drawing, diagnosis, unseen)
        result, left = conclude(diagnosis, unseen, options.seed, progress, search)
        result["reasons"] += reasons
        _tell_source(result, logs, scored, [*paths, *further], declare, options)
        write_report(diagnosis, left, result, drawing, out, progress, search, shown)
    journal.close(done=diagnosis.spent is None)
    return result


def _tell_source(
    result: dict,
    logs: list[Log],
    scored: list[Log],
    files: list[Path],
    declare: str,
    options: Options,
) -> None:
    """Add to a result what it was made from: logs, what is wrong with them, digests and options."""
    result["logs"] = described(logs)
    result["validation_logs"] = described(scored)
    result["findings"] = findings([*logs, *scored])
    given = {"declare": declare, "robot": result["robot"], **vars(options)}
    result["provenance"] = provenance(files, given)


def conclude(
    diagnosis: Diagnosis,
    unseen: list[Motion],
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
    search: Search | None = None,
) -> tuple[dict, list[Unexplained]]:
    """What remains after the loop, and everything as ``diagnosis.json`` has it."""
    progress("looking at what remains")
    left = find_unexplained(diagnosis.final, diagnosis.background, seed)
    left = proven(diagnosis.final, material(left, remainders(diagnosis.final)), unseen)
    result = to_result(diagnosis, left, unseen, search=search)
    result["physical_consistency"] = consistency_told(diagnosis.final)
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
    # Loaded while the other process draws: half a second.
    plots = importlib.import_module("jaxswarm.plots")
    pictures = importlib.import_module("jaxswarm.diagnose.report.figures")
    final = diagnosis.final
    robot, motion = final.model.robot, final.motions[0]
    figures = {"ladder.png": pictures.ladder(result)}
    for number, step in enumerate(diagnosis.kept, 1):
        figures[f"effect_{number}.png"] = pictures.evidence(step, final.model, motion)
    laws = {}
    for one in search.found if search else ():
        term, place = (
            one.added,
            [None if k is None else robot.joints[k] for k in (one.added.joint, one.added.other)],
        )
        figures[f"{law_name(place[0])}.png"] = pictures.evidence(one, final.model, motion)
        laws[f"{law_name(place[0])}.py"] = law_file(with_values(term.formula, term.values), *place)
    for item in left:
        rows = final.regression.log >= 0
        figures[f"unexplained_{robot.joints[item.joint]}.png"] = pictures.structure(
            item,
            final.fit.residual[rows, item.joint],
            robot.joints[item.joint],
            units(robot)[item.joint],
        )
    images = {name: plots.png_bytes(figure) for name, figure in figures.items()}
    images |= drawing.finished()
    outputs.write_results(
        out,
        {
            "diagnosis.json": outputs.to_json(result),
            "model.json": lambda path: save_model(with_smooth_terms(final, left), path),
            "report.html": render(result, images, shown),
            **images,
            **laws,
        },
    )
