"""Drift over time per joint: how far each arm is from the noise, and the parameters that changed."""

from collections.abc import Sequence
from itertools import groupby

import numpy as np
from matplotlib.figure import Figure

from jaxswarm.fleet.collect import Fleet
from jaxswarm.fleet.drift import Drift
from jaxswarm.fleet.mixed_model import Series
from jaxswarm.plots import ACCENT, MEASURED, MODEL, RESIDUAL, panels

# Arms that are drawn in a color of their own, and all that are drawn: more lines are one dark area.
_COLORS, _MOST = (MODEL, RESIDUAL, ACCENT), 200
# Changed parameters that are drawn.
_SHOWN = 6


def over_time(fleet: Fleet, arms: Sequence[str]) -> Figure | None:
    """Residual over noise of every joint over the dates of the logs, one line an arm.

    Args:
        fleet: All logs.
        arms: Names in order of rank; the first have a color of their own.

    Returns:
        The figure; None where no arm has logs of two days.
    """
    lines = {}
    for name, entries in groupby(fleet.entries, key=lambda one: one.source.arm):
        own = [e for e in entries if e.over_noise and e.source.date is not None]
        if len({e.source.date for e in own}) > 1:
            lines[name] = [e.source.date for e in own], np.array([e.over_noise for e in own])
    if not lines:
        return None
    ranked = [name for name in arms if name in lines][:_MOST]
    figure, axes = panels(len(fleet.joints), 1, 9.0, 1.9 * len(fleet.joints) + 0.7, sharex=True)
    for j, axis in enumerate(axes):
        for place, name in reversed(list(enumerate(ranked))):
            dates, values = lines[name]
            axis.plot(dates, values[:, j], **_look(place, name, j == 0))
        axis.axhline(1.0, color="k", lw=0.6, ls=":")
        axis.set_ylabel(f"{fleet.joints[j]}\nresidual / noise", fontsize=8)
    axes[0].legend(loc="upper left", ncols=3, frameon=False, fontsize=8)
    return _dated(figure, "what is left on every joint over the noise, arm by arm")


def changed(fleet: Fleet, drifts: Sequence[Drift]) -> Figure | None:
    """The parameters that changed most surely, over time, with those of the other arms behind them."""
    told = sorted((one for one in drifts if one.drifts), key=lambda one: one.q_value)[:_SHOWN]
    if not told:
        return None
    series = {one.parameter: one for one in fleet.series}
    figure, axes = panels(len(told), 1, 9.0, 1.9 * len(told) + 0.7)
    for axis, one in zip(axes, told, strict=True):
        unit = fleet.parameters[one.parameter][0]
        _parameter(axis, series[one.parameter], one.arm)
        axis.set_ylabel(f"{one.parameter[:18]}\n[{unit}]", fontsize=8)
        axis.legend(loc="upper left", frameon=False, fontsize=8)
    return _dated(figure, "parameters that changed over the logs of one arm")


def _parameter(axis, series: Series, arm: str) -> None:
    names = np.asarray(series.arms, dtype=object)
    days = np.where(np.isfinite(series.days), series.days, 0.0) * 86400.0
    dates = days.astype("datetime64[s]")
    known = np.isfinite(series.days)
    for other in list(dict.fromkeys(series.arms))[:_MOST]:
        own = (names == other) & known
        if other != arm:
            axis.plot(dates[own], series.values[own], color=MEASURED, lw=0.6, alpha=0.3)
    own = (names == arm) & known
    bars = 1.96 * series.errors[own]
    axis.errorbar(dates[own], series.values[own], bars, color=MODEL, lw=1.3, marker=".", label=arm)


def _look(place: int, name: str, labeled: bool) -> dict:
    if place < len(_COLORS):
        label = {"label": name} if labeled else {}
        return {"color": _COLORS[place], "lw": 1.4, "marker": ".", "zorder": 3, **label}
    return {"color": MEASURED, "lw": 0.6, "alpha": 0.35}


def _dated(figure: Figure, title: str) -> Figure:
    figure.autofmt_xdate()
    figure.suptitle(title, fontsize=11)
    return figure
