"""Identify a declared model from logs in memory."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from jaxswarm import outputs, plots
from jaxswarm.diagnose.selection.what_moves import fit_of_what_moves
from jaxswarm.effects.friction import USUAL_FRICTION
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.errors import InputError
from jaxswarm.identify.checks.check_log import checked
from jaxswarm.identify.checks.weak import refuse_weak
from jaxswarm.identify.estimation.clock_skew import estimate_with_clocks
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.model import Model, save_model
from jaxswarm.identify.options import Options, check_options, refined
from jaxswarm.identify.report.console import remarks, summary_line
from jaxswarm.identify.report.errors import base_table, error_rows, error_table
from jaxswarm.identify.report.report import report_of, torque_drawn
from jaxswarm.identify.run import (
    described,
    findings,
    refuse_missing_channels,
    refuse_resting_joints,
    refuse_undeclarable,
)
from jaxswarm.logs import Log
from jaxswarm.logs.motion import Filtering, Motion
from jaxswarm.logs.repeated import refuse_repeated_stretches
from jaxswarm.logs.shifted import with_skew_of
from jaxswarm.robot import Robot
from jaxswarm.tables import Result
from jaxswarm.tasks.inputs import Logs, as_logs, as_robot, in_double, refuse_shared
from jaxswarm.tasks.words import effect_table


@dataclass(frozen=True, eq=False, repr=False)
class Fitted(Result):
    """A result with a model.

    Attributes:
        model: The identified model.
        motion: The motion that pictures show: the validation log, else the first one.
    """

    model: Model | None = None
    motion: Motion | None = None

    @in_double
    def plot(self) -> Figure:
        """Measured and predicted torque of every joint over time, with the residual below."""
        model, motion = self.model, self.motion
        if model is None or motion is None or motion.tau is None:
            raise InputError("this result has no model with a measured torque to draw")
        return plots.torque_overlay(*torque_drawn(model, motion))

    def save(self, path: str | Path) -> Path:
        """Write the model as ``model.json``, which every command reads."""
        path, model = Path(path), self.model
        if model is None:
            raise InputError("this result has no model to save: its logs allow none")
        outputs.write_files(path.parent, {path.name: lambda part: save_model(model, part)})
        return path


def prepared(
    logs: Logs,
    robot: Robot,
    filtering: Filtering,
    terms: tuple[Term, ...],
    accept: Sequence[str] = (),
) -> tuple[list[Log], list[Motion]]:
    """Logs, and their stretches between gaps; the frequencies of the first one hold for all."""
    read = as_logs(logs, robot)
    if not read:
        raise InputError("no logs: pass at least one")
    refuse_missing_channels(terms, read)
    noted, motions = [], []
    for number, log in enumerate(read):
        refuse_repeated_stretches(log, read[:number])
        log, parts = checked(log, robot, filtering, accept)
        filtering = parts[0].filtering
        noted.append(log)
        motions += parts
    return noted, motions


@in_double
def identify(
    logs: Logs,
    robot: Robot | str | Path,
    effects: str = USUAL_FRICTION,
    *,
    validation: Logs | None = None,
    motion_cutoff: float | None = None,
    torque_cutoff: float | None = None,
    estimator: str = "least_squares",
    physical: bool = False,
    accept: Sequence[str] = (),
    progress: Callable[[str], None] = lambda text: None,
) -> Fitted:
    """Identify the rigid body and declared effects, by weighted least squares unless told otherwise.

    Where motion alone is near its noise, rows in which dry friction holds joints for moments are not fitted:
    ``held_at_rest`` says in which share of the time.

    Args:
        logs: A log or several, as :class:`jaxswarm.Log` or files.
        robot: A robot, a built-in name or a file; kinematics suffice.
        effects: ``none`` or ``name[@joint[:partner]],...``.
        validation: Another log, to score on.
        motion_cutoff: Low-pass of the positions [Hz]; None: found from the data.
        torque_cutoff: Low-pass shared by torque and model [Hz]; None: found from the data.
        estimator: ``least_squares``; ``instrumental`` or ``output_error`` for noisy encoders.
        physical: Whether to take the nearest rigid bodies in place of links that no rigid body can be.
        accept: Findings about the logs in spite of which they are fitted, by name.
        progress: Called with one line per stage.

    Returns:
        The content of ``identification.json``, with ``model``, ``plot()`` and ``save(path)``.

    Raises:
        InputError: On anything that cannot be used.
    """
    robot, options = as_robot(robot), Options(estimator=estimator, physical=physical)
    terms = parse_terms(effects, robot.joints)
    check_options(options)
    refuse_undeclarable(terms)
    read, motions = prepared(logs, robot, Filtering(motion_cutoff, torque_cutoff), terms, accept)
    refuse_resting_joints(read, robot)
    refuse_weak(motions, 10 * robot.num_joints, accept)
    unseen: list[Motion] | None = None
    scored: list[Log] = []
    if validation is not None:
        scored, unseen = prepared(validation, robot, motions[0].filtering, terms, accept)
        refuse_shared(read, scored)
    progress("fitting")
    found = fit_of_what_moves(estimate_with_clocks(robot, terms, list(motions)))
    if unseen is not None:
        unseen = [with_skew_of(part, found.motions[0]) for part in unseen]
    found, told, bodies = refined(found, options, progress)
    progress("scoring")
    report = report_of(found, described(read), unseen, scored[0].source if scored else None, None)
    report |= {"findings": findings([*read, *scored]), "validation_logs": described(scored)}
    report |= {"estimator": told, "physical_consistency": bodies}
    return _result(report, found, max(unseen or found.motions, key=lambda part: len(part.t)))


def _result(report: dict, found: Estimate, shown: Motion) -> Fitted:
    rows = error_rows(report)
    notes = [f"{log['source']}: {note}" for log in report["logs"] for note in log["notes"]]
    tables = (
        error_table(report["robot"], rows, report["joints"], report["torque_units"]),
        base_table(report["base_parameters"]),
        effect_table(report["effects"]),
    )
    lines = (summary_line(report), *notes, *remarks(report))
    return Fitted(report, lines, tables, model=found.model, motion=shown)
