"""Pictures of searches: convergence, a swarm in two dimensions over time, sweeps, runs that arrive.

Functions of plain arrays that return a matplotlib ``Figure``; matplotlib is imported when
one is drawn. Save with ``figure.savefig(path)``; notebooks show them.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.swarm.result import by_name
from jaxswarm.swarm.scales import to_values

__all__ = ["convergence_bands", "ecdf", "front_plot", "swarm_over_time", "sweep_map"]

COLORS = ("#2e6f95", "#d1495b", "#edae49", "#5b8c5a", "#7d5ba6", "#5b6770")
BAND = (25.0, 75.0)
"""Percentiles of the runs between which a band is drawn."""
DPI = 110


def convergence_bands(
    histories: Mapping[str, Any], *, per_step: Any = None, floor: float | None = None
):
    """Median best value over the evaluations, with the band of the middle half of the runs.

    Args:
      histories: by name, results, or best values (runs, steps) or (steps,) such as their ``history``.
      per_step: evaluations in a step, one number or by name; default counts steps.
      floor: the known optimum, which is subtracted; a line ends where it is reached. Without one, values
        below zero are drawn on a straight axis.

    >>> figure = convergence_bands({"pso": np.geomspace(1.0, 1e-3, 20) * np.ones((3, 1))})
    >>> figure.axes[0].get_yscale()
    'log'
    """
    figure, (axis,) = _figure(1, 6.4, 4.0)
    histories = by_name(histories, "history")
    runs = {name: _runs(name, history) - (floor or 0.0) for name, history in histories.items()}
    straight = floor is None and any((values < 0.0).any() for values in runs.values())
    for color, (name, values) in zip(_colors(histories), runs.items(), strict=True):
        size = per_step.get(name, 1) if isinstance(per_step, Mapping) else per_step or 1
        steps = size * np.arange(1, values.shape[1] + 1)
        least = -np.inf if straight else np.min(values, where=values > 0.0, initial=np.inf)
        held = values if straight else np.maximum(values, 0.0)
        low, middle, high = _percentiles(held, (BAND[0], 50.0, BAND[1]))
        middle = np.where(straight | (middle > 0.0), middle, np.nan)
        axis.plot(steps, middle, color=color, lw=1.6, label=f"{name} ({len(values)} runs)")
        if len(values) > 1:  # a run that has arrived is below the axis, and so may the band be
            inside = np.maximum(low, least), np.maximum(high, least)
            axis.fill_between(steps, *inside, color=color, alpha=0.2, lw=0)
    axis.set_yscale("linear" if straight else "log")
    axis.set_xlabel("steps" if per_step is None else "evaluations")
    axis.set_ylabel("best value" + (" above the optimum" if floor else ""))
    axis.legend(frameon=False, fontsize=9)
    return figure


def swarm_over_time(
    positions: Any, fn: Any = None, *, space: Any = None, steps: Sequence[int] | None = None
):
    """The candidates of a search in two dimensions at some of its steps, above contours of the objective.

    Args:
      positions: (steps, n, 2) of the unit cube, e.g. recorded with ``record=lambda s, i: s.position``.
      fn: objective of one candidate's parameters, ``fn(params, None)``; default no contours.
      space: of the search; needed with ``fn``, and for axes in its units.
      steps: which steps to show; default six from the first to the last, the early ones closer.
    """
    positions = np.asarray(positions, float)
    if positions.ndim != 3 or positions.shape[2] != 2:
        raise InputError(f"positions have shape {positions.shape}: give (steps, n, 2).")
    if fn is not None and space is None:
        raise InputError("fn is given without the space that decodes its parameters.")
    last = len(positions) - 1
    if steps is None:
        steps = sorted({round(last * share**2) for share in np.linspace(0.0, 1.0, 6)})
    columns = min(3, len(steps))
    rows = -(-len(steps) // columns)
    figure, axes = _figure(rows * columns, 3.1 * columns, 3.0 * rows, columns)
    ground = None if fn is None else _ground(fn, space)
    for axis, step in zip(axes, steps, strict=False):
        if ground is not None:
            axis.contourf(*ground, levels=24, cmap="Blues_r", alpha=0.75)
        axis.plot(*positions[step].T, "o", color=COLORS[1], ms=3.5, mec="white", mew=0.4)
        axis.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0), aspect="equal")
        axis.set_title(f"step {step}", fontsize=9)
        axis.grid(visible=False)
        _label_in_units(axis, space)
    for axis in axes[len(steps) :]:
        axis.set_visible(False)
    return figure


def sweep_map(
    values: Any,
    first: Any,
    second: Any,
    *,
    names: tuple[str, str] = ("first", "second"),
    label: str = "median best value",
    log: bool = True,
):
    """A heat map of what two coefficients of an optimizer do, with the best pair marked.

    Args:
      values: (len(first), len(second)), or with a last axis of runs, of which the median is shown.
      first, second: the coefficients, along the vertical and the horizontal axis.
      names: what to call them.
      label: what the values are.
      log: whether colors follow the logarithm.
    """
    from matplotlib.colors import LogNorm

    values, first, second = (np.asarray(given, float) for given in (values, first, second))
    values = np.median(values, axis=-1) if values.ndim == 3 else values
    if values.shape != (first.size, second.size):
        raise InputError(
            f"values have shape {values.shape} for {first.size} and {second.size} coefficients."
        )
    figure, (axis,) = _figure(1, 5.4, 4.2)
    norm = LogNorm() if log and (values > 0).all() and np.ptp(values) > 0 else None
    drawn = axis.imshow(values, origin="lower", aspect="auto", cmap="viridis_r", norm=norm)
    for ticks, given in ((axis.set_yticks, first), (axis.set_xticks, second)):
        every = max(1, -(-given.size // 10))
        ticks(np.arange(given.size)[::every], [f"{number:.3g}" for number in given[::every]])
    row, column = np.unravel_index(np.nanargmin(values), values.shape)
    axis.plot(column, row, "o", ms=11, mfc="none", mec=COLORS[1], mew=2.2)
    axis.set(ylabel=names[0], xlabel=names[1])
    axis.set_title(
        f"best {values[row, column]:.3g} at {names[0]}={first[row]:.3g}, "
        f"{names[1]}={second[column]:.3g}",
        fontsize=9,
    )
    axis.grid(visible=False)
    figure.colorbar(drawn, ax=axis, label=label)
    return figure


def ecdf(histories: Mapping[str, Any], targets: Any, *, per_step: Any = 1, dims: int = 1):
    """Share of (run, target) pairs reached over the evaluations: the runtime distribution of COCO.

    Args:
      histories: by name, best values above the optimum (runs, steps), of all problems together.
      targets: (m,) precisions, e.g. ``10.0 ** np.arange(2, -9, -1)``.
      per_step: evaluations in a step, one number or by name.
      dims: number of coordinates, by which evaluations are divided.

    Reference:
      N. Hansen, A. Auger, D. Brockhoff, D. Tusar, T. Tusar, "COCO: performance assessment", 2016,
      arXiv 1605.03560.
    """
    targets = np.asarray(targets, float).ravel()
    figure, (axis,) = _figure(1, 6.4, 4.0)
    for color, (name, history) in zip(_colors(histories), histories.items(), strict=True):
        best = np.minimum.accumulate(_runs(name, history), axis=1)
        reached = (best[:, :, None] <= targets).mean(axis=(0, 2))
        size = per_step.get(name, 1) if isinstance(per_step, Mapping) else per_step
        steps = size * np.arange(1, best.shape[1] + 1) / dims
        axis.step(steps, reached, where="post", color=color, lw=1.6, label=name)
    axis.set(xscale="log", ylim=(0.0, 1.02), ylabel="share of targets reached")
    axis.set_xlabel("evaluations" + (" / dimension" if dims > 1 else ""))
    axis.legend(frameon=False, fontsize=9)
    return figure


def front_plot(fronts: Mapping[str, Any], *, names: Sequence[str] | None = None):
    """Fronts of two objectives, or every pair of more.

    Args:
      fronts: by name, values (m, k), or what ``front(result, space)`` gives.
      names: of the objectives.
    """
    fronts = by_name(fronts, "values")
    sizes = {np.shape(values)[1] for values in fronts.values() if np.ndim(values) == 2}
    if len(sizes) != 1:
        raise InputError("fronts must hold arrays (m, k) with the same number of objectives.")
    objectives = sizes.pop()
    names = names or [f"objective {k + 1}" for k in range(objectives)]
    pairs = [(a, b) for a in range(objectives) for b in range(a + 1, objectives)]
    figure, axes = _figure(len(pairs), 4.6 * min(3, len(pairs)), 4.0, min(3, len(pairs)))
    for axis, (a, b) in zip(axes, pairs, strict=False):
        for color, (name, values) in zip(_colors(fronts), fronts.items(), strict=True):
            points = np.asarray(values, float)
            axis.plot(points[:, a], points[:, b], "o", ms=3.5, color=color, alpha=0.8, label=name)
        axis.set(xlabel=names[a], ylabel=names[b])
    axes[0].legend(frameon=False, fontsize=9)
    return figure


def _figure(count, width, height, columns=1):
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(-(-count // columns), columns, squeeze=False).ravel()
    for axis in axes:
        axis.spines[["top", "right"]].set_visible(False)
        axis.grid(alpha=0.25, linewidth=0.5)
    return figure, axes


def _runs(name, history):
    try:
        values = np.atleast_2d(np.asarray(history, float))
    except ValueError:
        raise InputError(
            f"histories[{name!r}] holds runs of different length: cut them to one."
        ) from None
    if values.ndim != 2:
        raise InputError(f"histories[{name!r}] has shape {values.shape}: give (runs, steps).")
    return values


def _colors(named):
    if not named:
        raise InputError("there is nothing to draw: give at least one array by name.")
    return [COLORS[i % len(COLORS)] for i in range(len(named))]


def _percentiles(values, shares):
    columns = np.isfinite(values).any(axis=0)
    out = np.full((len(shares), values.shape[1]), np.nan)
    out[:, columns] = np.nanpercentile(values[:, columns], shares, axis=0)
    return out


def _ground(fn, space):
    import jax

    line = np.linspace(0.0, 1.0, 81)
    grid = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    values = np.asarray(jax.vmap(lambda u: fn(space.decode(u), None))(jax.numpy.asarray(grid)))
    values = values.reshape(81, 81)
    # Heights over decades would leave one color at the bottom.
    return line, line, np.log10(values - np.nanmin(values) + 1e-3 * np.nanstd(values) + 1e-300)


def _label_in_units(axis, space):
    if space is None:
        return
    places = np.array([0.0, 0.5, 1.0])
    ends = np.asarray(space.lower), np.asarray(space.upper)
    values = np.array([np.asarray(to_values(np.full(2, u), *ends, space.scales)) for u in places])
    for k, axis_of in enumerate((axis.xaxis, axis.yaxis)):
        axis_of.set_ticks(places, [f"{value:.3g}" for value in values[:, k]])
        axis_of.set_label_text(space.names[k], fontsize=9)
