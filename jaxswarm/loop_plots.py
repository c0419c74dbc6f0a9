"""Pictures of what the loop found, of plain arrays: the ladder of errors, an effect, what no law explains."""

import numpy as np
from matplotlib.figure import Figure

from jaxswarm import plots

# Width of the ladder [in] at which its text has its own size on the page, and its panels side by side.
_WIDTH, _ACROSS = 9.5, 4


def evidence(
    label: str,
    x: np.ndarray | None,
    t: np.ndarray,
    partial: np.ndarray,
    told: np.ndarray,
    axis: str,
    title: str,
) -> Figure:
    """Partial residual of an effect: what the others leave, and what the effect says of it.

    Args:
        label, x: The variable the law is about, (T,); None: it is about time, and has one panel.
        t: Time [s], (T,).
        partial: Measured torque minus the model without the effect, (T,).
        told: Torque of the effect, (T,).
        axis: Joint and unit.
        title: Title of the figure.
    """
    figure, axes = plots.panels(1, 1 if x is None else 2, 9.5, 3.6, sharey=True)
    if x is not None:
        dots = {"marker": ".", "ls": "", "ms": 2}
        axes[0].plot(x, partial, alpha=0.4, color=plots.MEASURED, **dots)
        axes[0].plot(x, told, color=plots.MODEL, **dots)
        axes[0].set_xlabel(label)
    axes[-1].plot(t, partial, color=plots.MEASURED, lw=0.8, label="measured - others")
    axes[-1].plot(t, told, color=plots.MODEL, lw=0.8, label="effect")
    axes[-1].set_xlabel("time [s]")
    axes[0].set_ylabel(axis)
    # Above the panels, where it hides no dot.
    figure.legend(loc="outside upper right", frameon=False, fontsize=8, ncols=2, handlelength=1.2)
    figure.suptitle(title, fontsize=11)
    return figure


def ladder(
    errors: list[list[tuple[float, str]]], floor: list[float], names: list[str], titles: list[str]
) -> Figure:
    """Error of every joint on unseen motion, before and after each added effect; few panels a row.

    Args:
        errors: Of every model, of every joint: the RMS error, and how it is told.
        floor: Noise of every joint.
        names: Lines that name the models; they stand below all panels.
        titles: Of every joint.
    """
    columns = min(len(titles), _ACROSS)
    rows = -(-len(titles) // columns)
    # Beside the bars the names of the steps would take their room.
    foot = 0.2 + 0.18 * len(names)
    height = rows * (0.75 + 0.24 * len(errors)) + foot
    figure, axes = plots.panels(rows, columns, _WIDTH, height, sharey=True)
    figure.get_layout_engine().set(rect=(0.0, foot / height, 1.0, 1.0 - foot / height))
    for j, axis in enumerate(axes):
        if j >= len(titles):
            axis.set_axis_off()
            continue
        _bars(axis, [model[j] for model in errors], floor[j])
        axis.set_title(titles[j], fontsize=10)
    axes[0].set_yticks(np.arange(len(errors)), [str(k) for k in range(len(errors))])
    axes[0].invert_yaxis()
    words = "\n".join(names)
    figure.text(0.01, 0.02, words, fontsize=9, va="bottom", linespacing=1.3)
    figure.suptitle("error on unseen motion; dashed: noise", fontsize=11)
    return figure


def _bars(axis, errors: list[tuple[float, str]], floor: float) -> None:
    """The errors of one joint as bars with their numbers, the noise as a dashed line."""
    rms = [size for size, _ in errors]
    colors = [plots.MEASURED] + [plots.MODEL] * (len(errors) - 1)
    axis.barh(np.arange(len(errors)), rms, color=colors, height=0.66)
    for k, (size, text) in enumerate(errors):
        axis.text(size, k, text, ha="left", va="center", fontsize=9)
    axis.axvline(floor, color=plots.RESIDUAL, lw=1, ls="--")
    # Room for the numbers behind the longest bar.
    axis.set_xlim(0, 2.1 * max(max(rms), floor) or 1.0)
    axis.locator_params(axis="x", nbins=4)
    axis.tick_params(labelsize=9)


def structure(
    labels: list[str],
    variables: np.ndarray,
    residual: np.ndarray,
    smooth: np.ndarray,
    axis: str,
    title: str,
) -> Figure:
    """What an unexplained residual does along the variables it depends on.

    Args:
        labels, variables: Of m variables their names, and the values (T, m).
        residual, smooth: What is left, and the smooth function found in it, (T,) each.
        axis: Joint and unit.
        title: Title of the figure.
    """
    count = variables.shape[1]
    figure, axes = plots.panels(1, count, 4.5 * count + 0.5, 3.4)
    for panel, name, x in zip(axes, labels, variables.T, strict=True):
        panel.plot(x, residual, ".", ms=2, alpha=0.3, color=plots.MEASURED, label="residual")
        panel.plot(x, smooth, ".", ms=2, color=plots.MODEL, label="smooth function")
        panel.set_xlabel(name)
    axes[0].set_ylabel(axis)
    axes[0].legend(frameon=False, fontsize=8, markerscale=4)
    figure.suptitle(title, fontsize=11)
    return figure
