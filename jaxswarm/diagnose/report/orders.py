"""The large pictures of a diagnosis as orders of plain arrays, which another process may draw."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from jaxswarm.diagnose.report.shown import evidence_shown
from jaxswarm.diagnose.report.signals import Signals
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.step import Addition
from jaxswarm.drawing import Drawing
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.model import Model, model_torque
from jaxswarm.identify.report.report import torque_drawn
from jaxswarm.identify.report.summary import units
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot

_DERIVATIVES = (("q", ""), ("dq", "/s"), ("ddq", "/s^2"))


def order_pictures(drawing: Drawing, diagnosis: Diagnosis, unseen: list[Motion]) -> Signals:
    """Order the torque of the final model, what the declared and the final model leave, and every effect.

    Returns:
        The torque that is drawn.
    """
    final = diagnosis.final.model.during(None if unseen else 0)
    shown = unseen[0] if unseen else diagnosis.final.motions[0]
    drawn = torque_drawn(final, shown, f", final model, {Path(shown.source).name}")
    drawing.ask("torque.png", "plots.torque_overlay", *drawn)
    before = replace(diagnosis, final=diagnosis.declared)
    for name, one, title in (
        ("residual_before.png", before, "what the declared model leaves"),
        ("residual.png", diagnosis, "what the final model leaves"),
    ):
        drawing.ask(name, "plots.residual_dependence", *remaining(one, title))
    for number, step in enumerate(diagnosis.kept, 1):
        order_evidence(drawing, f"effect_{number}.png", step, diagnosis.final)
    return Signals(*drawn[:3])


def order_evidence(drawing: Drawing, name: str, step: Addition, final: Estimate) -> None:
    """Order what an effect says."""
    told = evidence_shown(step, *where_seen(step, final))
    drawing.ask(name, "loop_plots.evidence", *told)


def where_seen(step: Addition, final: Estimate) -> tuple[Model, Motion]:
    """The log in which an effect shows itself, its own if it is an event, and the model during it."""
    log = int(step.added.values.get("log", 0)) if step.added.law.in_one_log else 0
    return final.model.during(log), final.motions[log]


def remaining(diagnosis: Diagnosis, title: str) -> tuple:
    """Final residual on all fitted logs against position, velocity, acceleration, load and time."""
    found = diagnosis.final
    own = Model(found.model.robot, (), found.model.width, found.model.filtering, found.model.sigma)
    parts = []
    for motion in found.motions:
        kept = motion.decimator.kept(len(motion.t))
        rows = motion.q, motion.dq, motion.ddq, model_torque(own, motion), motion.t
        parts.append([x[kept] for x in rows])
    q, dq, ddq, load, t = map(np.concatenate, zip(*parts, strict=True))
    return (
        found.fit.residual,
        dict(zip(_axes(found.model.robot), (q, dq, ddq, load, t), strict=True)),
        found.model.robot.joints,
        units(found.model.robot),
        title if len(parts) == 1 else f"{title}, {len(parts)} fitted logs or parts of one",
    )


def _axes(robot: Robot) -> tuple[str, ...]:
    """What a residual is drawn against, with units: where joints turn and slide, those of both."""
    kinds = sorted(set(robot.kinds), reverse=True)
    place = ["m" if kind == "prismatic" else "rad" for kind in kinds]
    force = " or ".join(sorted(set(units(robot)), reverse=True))
    along = [f"{name} [{' or '.join(p + per for p in place)}]" for name, per in _DERIVATIVES]
    return *along, f"load [{force}]", "time [s]"
