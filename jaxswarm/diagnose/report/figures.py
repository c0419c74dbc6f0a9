"""The pictures of a diagnosis: the ladder of errors, the evidence for each effect, what no law explains."""

from textwrap import wrap

import numpy as np
from matplotlib.figure import Figure

from jaxswarm import plots
from jaxswarm.diagnose.decision.unexplained import Unexplained
from jaxswarm.diagnose.report.numbers import percent
from jaxswarm.diagnose.report.stages import stages
from jaxswarm.diagnose.selection.step import Addition
from jaxswarm.effects.alike import without
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.model import Model, model_torque
from jaxswarm.identify.report.summary import units
from jaxswarm.logs.motion import Motion

# Width of the ladder [in] at which its text has its own size on the page, and its panels side by side.
_WIDTH, _ACROSS = 9.5, 4
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
        "torque rate": (
            f"change of the model's torque on {motion.joints[felt]} [{torque}/s]",
            slope,
        ),
    }[term.law.shown_against]
    return label, values()


def evidence(step: Addition, final: Model, motion: Motion) -> Figure:
    """Partial residual of an effect: what the others leave, and what the effect says of it.

    Left against the variable the law is about, right over time; the dots are measured minus the final
    model without this effect, the line is the effect. A law about time has the right panel alone.
    """
    others = without(step.added, final.terms)
    bare = step.rest or Model(final.robot, others, final.width, final.filtering, final.sigma)
    low, kept = motion.decimator, motion.decimator.kept(len(motion.t))
    whole, rest = model_torque(final, motion), model_torque(bare, motion)
    contribution = low.apply(whole - rest)
    j = _felt(step.added, contribution.std(axis=0) / np.asarray(final.sigma))
    told, partial = contribution[:, j], low.apply(motion.tau - rest)[:, j]
    label, x = evidence_axis(step.added, final, motion, j)
    count = 1 if step.added.law.shown_against == "time" else 2
    figure, axes = plots.panels(1, count, 9.5, 3.6, sharey=True)
    if count == 2:
        dots = {"marker": ".", "ls": "", "ms": 2}
        axes[0].plot(x[kept], partial, alpha=0.4, color=plots.MEASURED, **dots)
        axes[0].plot(x[kept], told, color=plots.MODEL, **dots)
        axes[0].set_xlabel(label)
    axes[-1].plot(motion.t[kept], partial, color=plots.MEASURED, lw=0.8, label="measured - others")
    axes[-1].plot(motion.t[kept], told, color=plots.MODEL, lw=0.8, label="effect")
    axes[-1].set_xlabel("time [s]")
    axes[0].set_ylabel(f"{motion.joints[j]} [{units(final.robot)[j]}]")
    # Above the panels, where it hides no dot.
    figure.legend(loc="outside upper right", frameon=False, fontsize=8, ncols=2, handlelength=1.2)
    figure.suptitle(step.added.label(motion.joints), fontsize=11)
    return figure


def _felt(term: Term, sizes: np.ndarray) -> int:
    """The joint on which an effect is drawn: its own, or the one that feels it most where that hardly does.

    A link that sits elsewhere than the model says is felt by the joints before it.
    """
    most = int(np.argmax(sizes))
    return most if term.joint is None or sizes[term.joint] < _HARDLY * sizes[most] else term.joint


def ladder(result: dict) -> Figure:
    """Error of every joint on unseen motion, before and after each added effect; few panels a row."""
    models = stages(result)
    joints, labels = result["joints"], result["torque_units"]
    columns = min(len(joints), _ACROSS)
    rows = -(-len(joints) // columns)
    # The names of the steps stand once, below all panels: beside the bars they would take their room.
    names = [
        part
        for k, stage in enumerate(models)
        for part in wrap(f"{k}: {stage.name}", _LETTERS, subsequent_indent="    ")
    ]
    foot = 0.2 + 0.18 * len(names)
    height = rows * (0.75 + 0.24 * len(models)) + foot
    figure, axes = plots.panels(rows, columns, _WIDTH, height, sharey=True)
    figure.get_layout_engine().set(rect=(0.0, foot / height, 1.0, 1.0 - foot / height))
    floor = result["error"]["noise_floor"]["rms"]
    for j, axis in enumerate(axes):
        if j >= len(joints):
            axis.set_axis_off()
            continue
        _bars(axis, [stage.after for stage in models], j, floor[j])
        axis.set_title(f"{joints[j]} [{labels[j]}]", fontsize=10)
    axes[0].set_yticks(np.arange(len(models)), [str(k) for k in range(len(models))])
    axes[0].invert_yaxis()
    words = "\n".join(names)
    figure.text(0.01, 0.02, words, fontsize=9, va="bottom", linespacing=1.3)
    figure.suptitle("error on unseen motion; dashed: noise", fontsize=11)
    return figure


def _bars(axis, stages: list[dict], j: int, floor: float) -> None:
    """The errors of one joint as bars with their numbers, the noise as a dashed line."""
    rms = [errors["rms"][j] for errors in stages]
    colors = [plots.MEASURED] + [plots.MODEL] * (len(stages) - 1)
    axis.barh(np.arange(len(stages)), rms, color=colors, height=0.66)
    for k, errors in enumerate(stages):
        text = f" {rms[k]:.3g} ({percent(errors['relative'][j], 1)})"
        axis.text(rms[k], k, text, ha="left", va="center", fontsize=9)
    axis.axvline(floor, color=plots.RESIDUAL, lw=1, ls="--")
    # Room for the numbers behind the longest bar.
    axis.set_xlim(0, 2.1 * max(max(rms), floor) or 1.0)
    axis.locator_params(axis="x", nbins=4)
    axis.tick_params(labelsize=9)


def structure(item: Unexplained, residual: np.ndarray, joint: str, unit: str) -> Figure:
    """What an unexplained residual does along the variables it depends on."""
    count = item.variables.shape[1]
    figure, axes = plots.panels(1, count, 4.5 * count + 0.5, 3.4)
    for axis, name, x in zip(axes, item.depends_on, item.variables.T, strict=True):
        axis.plot(x, residual, ".", ms=2, alpha=0.3, color=plots.MEASURED, label="residual")
        axis.plot(x, item.smooth, ".", ms=2, color=plots.MODEL, label="smooth function")
        axis.set_xlabel(name)
    axes[0].set_ylabel(f"{joint} [{unit}]")
    axes[0].legend(frameon=False, fontsize=8, markerscale=4)
    figure.suptitle(
        f"no known law: {joint} depends on {', '.join(item.depends_on)} ({percent(item.share, 0)})",
        fontsize=11,
    )
    return figure
