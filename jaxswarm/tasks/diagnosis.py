"""Find what a declared model lacks, or what changed since a model, from logs in memory."""

from collections.abc import Callable, Sequence
from pathlib import Path

from jaxswarm.diagnose.asked_again import doubtful, told_again
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.unexplained import with_smooth_terms
from jaxswarm.diagnose.discovery.discover import discover as find_formulas
from jaxswarm.diagnose.memory import refuse_too_large
from jaxswarm.diagnose.report.text import next_steps, verdict_sentence, where
from jaxswarm.diagnose.run import conclude
from jaxswarm.diagnose.run_against import conclude_comparison
from jaxswarm.diagnose.selection.budget import Budget, given_budget
from jaxswarm.diagnose.selection.changes import compare as changes_since
from jaxswarm.diagnose.selection.stepwise import diagnose as search
from jaxswarm.diagnose.unfit import undecided_by
from jaxswarm.effects.term import parse_terms
from jaxswarm.errors import InputError
from jaxswarm.identify.checks.weak import refuse_weak, resting_joints
from jaxswarm.identify.forward.model import Model
from jaxswarm.identify.report.errors import error_table
from jaxswarm.identify.run import refuse_resting_joints, refuse_undeclarable, told_of
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import Filtering, Motion
from jaxswarm.logs.segments import prepare_all
from jaxswarm.robot import Robot
from jaxswarm.tasks.identification import Fitted, prepared
from jaxswarm.tasks.inputs import Logs, as_model, as_robot, in_double, refuse_shared
from jaxswarm.tasks.words import effect_table


@in_double
def diagnose(
    logs: Logs,
    robot: Robot | str | Path,
    declare: str | None = None,
    *,
    model: Model | str | Path | None = None,
    validation: Logs | None = None,
    rules: Rules | None = None,
    seed: int = 0,
    motion_cutoff: float | None = None,
    torque_cutoff: float | None = None,
    accept: Sequence[str] = (),
    budget: float | None = None,
    discover: bool = False,
    progress: Callable[[str], None] = lambda text: None,
) -> Fitted:
    """Find the effect a declared model lacks, add it, and show the error before and after.

    Args:
        logs: A log or several, as :class:`jaxswarm.Log` or files.
        robot: A robot, a built-in name or a file; kinematics suffice.
        declare: What is known to be there: ``none`` (default) or ``name[@joint[:partner]],...``.
        model: A model identified before, in place of ``declare``: find what changed since.
        validation: Further logs, to score on.
        rules: Thresholds of the decision; like the cutoffs with ``declare`` only.
        seed: Seed of the searches.
        motion_cutoff, torque_cutoff: Low-pass [Hz] of positions, and of torque and model; None: from the data.
        accept: Findings about the logs in spite of which they are fitted, by name.
        budget: Time [s] after which no further round of the search begins; None: no limit.
        discover: Whether to search a formula for what no law explains; with ``declare`` only.
        progress: Called with one line per stage.

    Returns:
        The content of ``diagnosis.json``, with ``model``, ``plot()`` and ``save(path)``.

    Raises:
        InputError: On anything that cannot be used.
    """
    robot, limit = as_robot(robot), given_budget(budget)
    if model is not None:
        _refuse_beside_model((declare, rules, motion_cutoff, torque_cutoff), discover)
        return _against(logs, as_model(model), validation, seed, limit, progress, accept)
    terms = parse_terms(declare or "none", robot.joints)
    refuse_undeclarable(terms)
    read, motions = prepared(logs, robot, Filtering(motion_cutoff, torque_cutoff), terms, accept)
    scored, other = _scored(validation, read, robot, motions[0].filtering, terms, accept)
    unfit = undecided_by(motions, robot, terms, accept)
    told = told_of(read, scored)
    if unfit is not None:
        return Fitted(unfit | told, (verdict_sentence(unfit),), (), motion=motions[0])
    refuse_too_large(motions)
    found = search(
        robot, terms, motions, rules=rules, seed=seed, progress=progress, other=other, budget=limit
    )
    unseen = prepare_all(scored, found.final.model.filtering)
    found, formulas = find_formulas(found, unseen, seed, progress) if discover else (found, None)
    result, left = conclude(found, unseen, seed, progress, formulas)
    result["reasons"] += resting_joints(motions, robot)
    result |= told_again(told, result, doubtful(read, scored), found.final.model)
    return _result(result, with_smooth_terms(found.final, left), unseen or found.final.motions)


def _scored(
    validation: Logs | None,
    read: Sequence,
    robot: Robot,
    filtering: Filtering,
    terms: tuple,
    accept: Sequence[str],
) -> tuple[list[Log], list[Motion]]:
    """Logs to score on, and their stretches between gaps; none of them may be a fitted one."""
    if validation is None:
        return [], []
    scored, unseen = prepared(validation, robot, filtering, terms, accept)
    refuse_shared(read, scored)
    return scored, unseen


def _refuse_beside_model(held: tuple, discover: bool) -> None:
    """Refuse what an earlier model holds already, and a search that only a declaration has."""
    if any(one is not None for one in held):
        raise InputError("model excludes declare, rules and cutoffs: the model holds them")
    if discover:
        raise InputError("discover=True goes with declare: against a model nothing is searched")


def _against(
    logs: Logs, model: Model, validation, seed: int, budget: Budget, progress, accept
) -> Fitted:
    read, motions = prepared(logs, model.robot, model.filtering, model.terms, accept)
    refuse_resting_joints(read, model.robot)
    refuse_weak(motions, 10 * model.robot.num_joints, accept)
    scored, unseen = _scored(validation, read, model.robot, model.filtering, model.terms, accept)
    refuse_too_large(motions)
    found = changes_since(model, motions, seed=seed, progress=progress, budget=budget)
    result, diagnosis, left = conclude_comparison(found, unseen, seed, progress)
    after = with_smooth_terms(diagnosis.final, left)
    result |= told_again(told_of(read, scored), result, doubtful(read, scored), after)
    return _result(result, after, unseen or motions)


def _result(result: dict, model: Model, shown: Sequence[Motion]) -> Fitted:
    rows = {"declared model": result["error"]["before"]}
    rows |= {f"+ {where(step['added'])}": step["after"] for step in result["steps"]}
    tables = (
        error_table(
            f"{result['robot']}: on unseen motion", rows, result["joints"], result["torque_units"]
        ),
        *(
            effect_table(result[key], title)
            for key, title in (("effects", "added effects"), ("changed", "changed effects"))
            if result[key]
        ),
    )
    lines = (verdict_sentence(result), *result.get("reasons", ()), *next_steps(result))
    return Fitted(result, lines, tables, model=model, motion=shown[0])
