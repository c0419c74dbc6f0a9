"""What the pictures of a diagnosis show, as plain arrays and words for :mod:`jaxswarm.loop_plots`."""

from textwrap import wrap

import numpy as np

from jaxswarm.diagnose.decision.unexplained import Unexplained
from jaxswarm.diagnose.report.numbers import percent
from jaxswarm.diagnose.report.stages import stages
from jaxswarm.diagnose.selection.step import Addition
from jaxswarm.effects.alike import without
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.model import Model, model_torque
from jaxswarm.identify.report.summary import units
from jaxswarm.logs.motion import Motion

# An effect is drawn on its own joint if that feels this share of what another one does, in its own noise.
_HARDLY = 0.3
# Letters below the panels that fit into a line.
_LETTERS = 110


def evidence_axis(
    term: Term, model: Model, motion: Motion, shown: int | None = None
) -> tuple[str, np.ndarray]:
    """The variable against which an effect shows itself: label and values (T,).

    Args:
        term: The effect.
        model: The final model.
        motion: A log.
        shown: The joint whose torque is drawn; None: the effect's own.
    """
    j = (shown or 0) if term.joint is None else term.joint
    felt = j if shown is None else shown
    partner = j if term.other is None else term.other
    (name, other), torque = (motion.joints[k] for k in (j, partner)), units(model.robot)[felt]
    own, its = ("rad" if model.robot.kinds[k] == "revolute" else "m" for k in (j, partner))

    def load() -> np.ndarray:
        bare = Model(model.robot, (), model.width, model.filtering, model.sigma)
        sign = np.tanh(motion.dq[:, felt] / model.width[felt])
        return np.abs(model_torque(bare, motion)[:, felt]) * sign

    def modeled() -> np.ndarray:
        return model_torque(model, motion)[:, felt]

    def slope() -> np.ndarray:
        # In the band in which torques are compared: a sign that turns has no slope.
        low, rate = motion.decimator, np.gradient(modeled(), motion.t)
        return np.interp(motion.t, motion.t[low.kept(len(rate))], low.apply(rate[:, None])[:, 0])

    label, values = {
        "position": (f"q of {name} [{own}]", lambda: motion.q[:, j]),
        "velocity": (f"dq of {name} [{own}/s]", lambda: motion.dq[:, j]),
        "acceleration": (f"ddq of {name} [{own}/s^2]", lambda: motion.ddq[:, j]),
        "time": ("time [s]", lambda: motion.t),
        "partner position": (f"q of {other} [{its}]", lambda: motion.q[:, partner]),
        "partner velocity": (f"dq of {other} [{its}/s]", lambda: motion.dq[:, partner]),
        "load": (f"|load| sign(dq) of {motion.joints[felt]} [{torque}]", load),
        "model torque": (f"torque of the model on {motion.joints[felt]} [{torque}]", modeled),
        "partner torque": (
            f"torque of the model on {other} [{units(model.robot)[partner]}]",
            lambda: model_torque(model, motion)[:, partner],
        ),
        "torque rate": (
            f"change of the model's torque on {motion.joints[felt]} [{torque}/s]",
            slope,
        ),
    }[term.law.shown_against]
    return label, values()


def evidence_shown(step: Addition, final: Model, motion: Motion) -> tuple:
    """What :func:`jaxswarm.loop_plots.evidence` draws of an effect.

    Left against the variable the law is about, right over time; the dots are measured minus the final
    model without this effect, the line is the effect. A law about time has the right panel alone.
    """
    bare = step.rest
    if bare is None:  # else it may be a payload, which is in the last link and no term of the model
        others = without(step.added, final.terms)
        bare = Model(final.robot, others, final.width, final.filtering, final.sigma)
    low, kept = motion.decimator, motion.decimator.kept(len(motion.t))
    whole, rest = model_torque(final, motion), model_torque(bare, motion)
    contribution = low.apply(whole - rest)
    j = _felt(step.added, contribution.std(axis=0) / np.asarray(final.sigma))
    told, partial = contribution[:, j], (motion.known_torque - low.apply(rest))[:, j]
    label, x = evidence_axis(step.added, final, motion, j)
    return (
        label,
        None if step.added.law.shown_against == "time" else x[kept],
        motion.t[kept],
        partial,
        told,
        f"{motion.joints[j]} [{units(final.robot)[j]}]",
        step.added.label(motion.joints),
    )


def _felt(term: Term, sizes: np.ndarray) -> int:
    """The joint on which an effect is drawn: its own, or the one that feels it most where that hardly does.

    A link that sits elsewhere than the model says is felt by the joints before it.
    """
    most = int(np.argmax(sizes))
    return most if term.joint is None or sizes[term.joint] < _HARDLY * sizes[most] else term.joint


def ladder_shown(result: dict) -> tuple:
    """What :func:`jaxswarm.loop_plots.ladder` draws of ``diagnosis.json``."""
    models = stages(result)
    joints, labels = result["joints"], result["torque_units"]
    errors = [
        [
            (rms, f" {rms:.3g} ({percent(relative, 1)})")
            for rms, relative in zip(stage.after["rms"], stage.after["relative"], strict=True)
        ]
        for stage in models
    ]
    names = [
        part
        for k, stage in enumerate(models)
        for part in wrap(f"{k}: {stage.name}", _LETTERS, subsequent_indent="    ")
    ]
    titles = [f"{joint} [{unit}]" for joint, unit in zip(joints, labels, strict=True)]
    return errors, result["error"]["noise_floor"]["rms"], names, titles


def structure_shown(item: Unexplained, residual: np.ndarray, joint: str, unit: str) -> tuple:
    """What :func:`jaxswarm.loop_plots.structure` draws of an unexplained residual (T,)."""
    variables = ", ".join(item.depends_on)
    title = f"no known law: {joint} depends on {variables} ({percent(item.share, 0)})"
    told = item.depends_on, item.variables, residual, item.smooth
    return *told, f"{joint} [{unit}]", title
