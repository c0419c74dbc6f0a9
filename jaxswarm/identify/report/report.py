"""An identification as plain data and as pictures."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jaxswarm.drawing import Drawing
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.standing import held_shares
from jaxswarm.identify.estimation.validate import held_out_errors, log_errors
from jaxswarm.identify.forward.begun import in_state_of
from jaxswarm.identify.forward.model import Model, model_torque
from jaxswarm.identify.report.summary import (
    base_parameter_table,
    correlation,
    term_parameters,
    unidentified,
    units,
)
from jaxswarm.logs.motion import Motion

if TYPE_CHECKING:  # the swarms load for a tenth of a second what only a search needs
    from jaxswarm.identify.estimation.swarm_fit import SwarmFit


def report_of(
    found: Estimate, logs: list[dict], unseen, validation, search: "SwarmFit | None"
) -> dict:
    """The content of ``identification.json``: values, uncertainty, what is inseparable, errors.

    Args:
        found: The fit.
        logs: Their summaries with what was found, as plain data.
        unseen: Prepared stretches of the validation log, or None.
        validation: Its path.
        search: The swarm's search, where one was asked for.
    """
    model, solution = found.model, found.fit
    robot = model.robot
    train = [{"log": Path(m.source).name, **log_errors(model, m)} for m in found.motions]
    report = {
        "robot": robot.name,
        "joints": list(robot.joints),
        "effects": [
            {
                "effect": t.effect,
                "joint": None if t.joint is None else robot.joints[t.joint],
                "other": None if t.other is None else robot.joints[t.other],
                "parameters": term_parameters(t, robot, errors),
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
            "motion_cutoff_hz": list(found.motions[0].motion_cutoff),
            "torque_cutoff_hz": found.motions[0].torque_cutoff,
            "clock_skew_s": found.motions[0].skew,
            "weight_skew_s": found.motions[0].weight_skew,
        },
        "residual_std": solution.sigma,
        "held_at_rest": held_shares(found.motions),
        "torque_units": units(robot),
        "logs": logs,
        "error": {
            "train": train[0] if len(train) == 1 else train,
            "held_out_blocks": held_out_errors(found),
            "validation": None
            if unseen is None
            else log_errors(in_state_of(model, unseen), *unseen),
            "validation_log": None if validation is None else str(validation),
        },
        "optimizer": {"name": "least_squares", "cost": solution.cost},
    }
    if search is not None:
        report["optimizer"] = _of_search(search)
    return report


def _of_search(search: "SwarmFit") -> dict:
    """What the runs of a swarm reached, beside the least-squares cost."""
    return {
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


def torque_drawn(model: Model, motion: Motion, told: str = "") -> tuple:
    """Arguments of ``plots.torque_overlay``: a log's torque, what a model makes of it, and a title.

    Args:
        model: The model.
        motion: A log with torque.
        told: What the title says beside the robot and the cutoff.
    """
    low, robot = motion.decimator, model.robot
    return (
        motion.t[low.kept(len(motion.t))],
        motion.known_torque,
        low.apply(model_torque(model, motion)),
        robot.joints,
        units(robot),
        f"{robot.name}: torque below {motion.torque_cutoff:.3g} Hz{told}",
    )


def order_pictures(
    drawing: Drawing, found: Estimate, motion: Motion, search: "SwarmFit | None"
) -> None:
    """Order the pictures by file name: torque, residual, and the swarm's convergence."""
    log = Path(motion.source).name
    drawn = torque_drawn(found.model, motion, f", {log}")
    _, measured, predicted, joints, labels, _ = drawn
    drawing.ask("torque.png", "plots.torque_overlay", *drawn)
    known = ~motion.lost_rows
    rows = np.arange(len(motion.t))[motion.decimator.kept(len(motion.t))][known]
    drawing.ask(
        "residual.png",
        "plots.residual_dependence",
        (measured - predicted)[known],
        {
            "q": motion.q[rows],
            "dq": motion.dq[rows],
            "ddq": motion.ddq[rows],
            "torque": measured[known],
            "time [s]": motion.t[rows],
        },
        joints,
        labels,
        f"{found.model.robot.name}: what the model leaves, {log}",
    )
    if search is not None:
        drawing.ask(
            "convergence.png",
            "plots.convergence",
            {search.optimizer: np.asarray(search.history)},
            float(search.optimum),
            f"{search.optimizer}: {len(search.costs)} runs against least squares",
        )
