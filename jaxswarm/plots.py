"""Pictures of torques, residuals and searches. Functions of plain arrays that return figures."""

import io
from collections.abc import Iterator

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import FixedFormatter, FuncFormatter

MEASURED, MODEL, RESIDUAL, ACCENT = "#5b6770", "#d1495b", "#2e6f95", "#edae49"
_DPI = 110
# Dots of one panel: more of them cover each other, and take as long to draw as to fit.
_DOTS = 10_000


def _grid(rows: int, columns: int, width: float, height: float, **options) -> tuple:
    figure = Figure(figsize=(width, height), dpi=_DPI, layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False, **options)
    for axis in axes.flat:
        axis.spines[["top", "right"]].set_visible(False)
        axis.grid(alpha=0.25, linewidth=0.5)
    return figure, axes


def _arrange(figure: Figure, axes: np.ndarray, title: str, across: float, between: float) -> None:
    """Title and margins in inches for many panels: the constrained layout takes as long as the drawing.

    Args:
        figure: The figure.
        axes: Its axes in a grid, y labels on the first column alone.
        title: Title of the figure.
        across, between: Space between columns, and between rows.
    """
    (rows, columns), (width, height) = axes.shape, figure.get_size_inches()
    left, right, bottom, top = 0.9, 0.12, 0.5, 0.42
    figure.set_layout_engine(None)
    figure.subplots_adjust(
        left=left / width,
        right=1.0 - right / width,
        bottom=bottom / height,
        top=1.0 - top / height,
        wspace=across * columns / (width - left - right - across * (columns - 1)),
        hspace=between * rows / (height - bottom - top - between * (rows - 1)),
    )
    figure.align_ylabels(axes[:, 0])
    figure.suptitle(title, fontsize=11, y=1.0 - 0.08 / height, va="top")


def panels(rows: int, columns: int, width: float, height: float, **options):
    """A figure with its axes in one flat list, in the style of all pictures here."""
    figure, axes = _grid(rows, columns, width, height, **options)
    return figure, list(axes.flat)


def torque_overlay(t, measured, predicted, joints, units, title="") -> Figure:
    """Measured and predicted torque of every joint over time, with the residual below.

    Args:
        t: Time [s], shape (T,).
        measured, predicted: Shape (T, n); measured may hold NaN, where its line ends.
        joints, units: n names and torque units.
        title: Title of the figure.
    """
    n = len(joints)
    figure, axes = _grid(2 * n, 1, 9.0, 2.4 * n + 0.6, sharex=True, height_ratios=[3, 1.2] * n)
    for j in range(n):
        top, bottom = axes[2 * j, 0], axes[2 * j + 1, 0]
        top.plot(t, measured[:, j], color=MEASURED, lw=1.2, label="measured")
        top.plot(t, predicted[:, j], color=MODEL, lw=0.9, label="model")
        top.set_ylabel(units[j])
        top.text(
            0.005, 0.97, joints[j], va="top", transform=top.transAxes, fontsize=9, weight="bold"
        )  # fmt: skip
        error = measured[:, j] - predicted[:, j]
        bottom.plot(t, error, color=RESIDUAL, lw=0.7)
        bottom.axhline(0.0, color="k", lw=0.5)
        bottom.set_ylabel("residual", fontsize=8)
        bottom.text(
            0.995, 0.9, f"RMS {np.sqrt(np.nanmean(error**2)):.3g} {units[j]}",
            ha="right", va="top", transform=bottom.transAxes, fontsize=8,
        )  # fmt: skip
    axes[0, 0].legend(loc="upper right", ncols=2, frameon=False, fontsize=8)
    axes[-1, 0].set_xlabel("time [s]")
    _arrange(figure, axes, title, 0.1, 0.12)
    return figure


def binned(
    x: np.ndarray, y: np.ndarray, bins: int = 25
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Median of x, mean of y and standard error of that mean in bins of equal count."""
    order = np.argsort(x)
    parts = [p for p in np.array_split(order, min(bins, max(1, len(x) // 4))) if p.size]
    return (
        np.array([np.median(x[p]) for p in parts]),
        np.array([y[p].mean() for p in parts]),
        np.array([y[p].std() / np.sqrt(p.size) for p in parts]),
    )


def residual_dependence(residual, variables, joints, units, title="") -> Figure:
    """Residual of every joint against every variable, dots and binned means with two standard errors.

    Args:
        residual: Shape (T, n).
        variables: Label to array of shape (T, n) or (T,).
        joints, units: n names and torque units.
        title: Title of the figure.
    """
    n, m = len(joints), len(variables)
    shown = slice(None, None, -(-len(residual) // _DOTS))
    figure, axes = _grid(n, m, 2.6 * m + 0.6, 2.1 * n + 0.6, sharey="row")
    for k, (label, values) in enumerate(variables.items()):
        values = np.broadcast_to(np.asarray(values).reshape(len(residual), -1), residual.shape)
        for j in range(n):
            axis = axes[j, k]
            dots = values[shown, j], residual[shown, j]
            axis.plot(*dots, ".", ms=1.5, alpha=0.25, color=MEASURED)
            center, mean, error = binned(values[:, j], residual[:, j])
            axis.errorbar(center, mean, 2 * error, color=MODEL, lw=1.2, elinewidth=0.7)
            axis.locator_params(nbins=4)
            if j == n - 1:
                axis.set_xlabel(label)
            if k == 0:
                axis.set_ylabel(f"{joints[j]} [{units[j]}]")
    _arrange(figure, axes, title, 0.1, 0.3)
    return figure


def convergence(histories: dict[str, np.ndarray], optimum: float, title="") -> Figure:
    """Median and quartile band of the excess over the optimum, per step.

    Args:
        histories: Label to best cost after each step, shape (runs, steps).
        optimum: Cost of the exact solution.
        title: Title of the figure.
    """
    figure, axes = _grid(1, 1, 7.0, 4.0)
    axis = axes[0, 0]
    for k, (label, history) in enumerate(histories.items()):
        excess = np.maximum(history / optimum - 1.0, 1e-16)
        low, middle, high = np.quantile(excess, [0.25, 0.5, 0.75], axis=0)
        steps = np.arange(1, history.shape[1] + 1)
        color = (MODEL, RESIDUAL, ACCENT, MEASURED)[k % 4]
        axis.semilogy(steps, middle, color=color, label=label)
        axis.fill_between(steps, low, high, color=color, alpha=0.2, lw=0)
    axis.set_xlabel("step")
    axis.set_ylabel("cost above the optimum, relative")
    axis.legend(frameon=False)
    figure.suptitle(title, fontsize=11)
    return figure


def png(figure: Figure):
    """A writer of the figure for :func:`jaxswarm.outputs.write_files`."""
    return lambda path: path.write_bytes(png_bytes(figure))


def png_bytes(figure: Figure) -> bytes:
    """The figure as a PNG file's content."""
    buffer = io.BytesIO()
    _take_text_literally(figure)
    # savefig() draws everything twice, the first time for a bounding box that is not asked for here.
    FigureCanvasAgg(figure).print_png(buffer)
    return buffer.getvalue()


def _take_text_literally(figure: Figure) -> None:
    """Names are no formulas, whatever dollar signs they hold; the numbers of an axis may be."""
    for text in _words(figure):
        text.set_parse_math(False)
        # Bytes of a path that are no UTF-8 cannot be drawn.
        text.set_text(text.get_text().encode("utf-8", "backslashreplace").decode("utf-8"))


def _words(artist: Artist) -> Iterator[Text]:
    """The texts of a figure; the ticks of an axis with numbers, a thousand objects, are passed over."""
    if isinstance(artist, Text):
        yield artist
    if isinstance(artist, Axis):
        yield artist.label
        if isinstance(artist.get_major_formatter(), FixedFormatter | FuncFormatter):
            yield from artist.get_ticklabels(which="both")
        return
    for child in artist.get_children():
        yield from _words(child)
