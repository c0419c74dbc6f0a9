"""Torque over time on the page, to be looked into: a drawing that stands by itself, and zoom and values on top.

The drawing is SVG: measured torque, model, and their difference below, one panel a joint. Without scripts it
reads as a picture does. With them a drag zooms all joints, a pointer shows the values, and keys move along.
Of a long log each piece of time keeps the extremes of torque and residual, so that no peak is lost.
"""

import json
from html import escape
from typing import NamedTuple

import numpy as np

from jaxswarm.diagnose.report.signals_script import SCRIPT

# Points of a joint that the page holds; more make it slow to open, and no screen shows them.
MOST = 6000
# Points that the drawing without scripts shows, about two a pixel of a wide screen.
_DRAWN = 1600
# Drawing units: width, height of the torque, of the residual, and the gap between them.
_WIDTH, _TOP, _LOW, _GAP = 1000.0, 150.0, 60.0, 12.0
_DIGITS = 5


class Signals(NamedTuple):
    """Torque of the motion that pictures show.

    Attributes:
        t: Time [s], (T,).
        measured, predicted: Torque of every joint [N m or N], (T, n); measured is NaN in the gaps of a log.
    """

    t: np.ndarray
    measured: np.ndarray
    predicted: np.ndarray


def kept_rows(values: np.ndarray, most: int) -> np.ndarray:
    """Rows that keep the extremes of every piece of a signal.

    Args:
        values: Signals (T, k).
        most: How many rows at most.

    >>> x = np.zeros(1000)
    >>> x[617] = 1.0
    >>> 617 in kept_rows(x[:, None], 100)
    True
    """
    length, count = values.shape
    if length <= most:
        return np.arange(length)
    pieces = np.array_split(np.arange(length), max(1, most // (2 * count)))
    ends = [(np.argmin, np.nan_to_num(values, nan=np.inf))]
    ends.append((np.argmax, np.nan_to_num(values, nan=-np.inf)))
    extremes = [piece[f(of[piece], axis=0)] for piece in pieces for f, of in ends]
    return np.unique(np.concatenate(extremes))


def section(signals: Signals | None, joints: list[str], units: list[str]) -> str:
    """The panels of all joints with their data; nothing where nothing was drawn."""
    if signals is None or len(signals.t) < 2:
        return ""
    panels, data = [], []
    for j, (joint, unit) in enumerate(zip(joints, units, strict=True)):
        pair = np.column_stack([signals.measured[:, j], signals.predicted[:, j]])
        both = np.column_stack([pair[:, 0], pair[:, 0] - pair[:, 1]])
        rows = kept_rows(both, MOST)
        panels.append(_panel(signals.t, pair, kept_rows(both, _DRAWN), joint, unit, j))
        data.append([_listed(signals.t[rows]), *(_listed(x) for x in pair[rows].T)])
    gaps = " Where nothing was measured, lines end." if np.isnan(signals.measured).any() else ""
    first, last = float(signals.t[0]), float(signals.t[-1])
    told = json.dumps({"span": [first, last], "joints": data}, separators=(",", ":"))
    return (
        '<section class="signals" aria-label="torque over time">'
        "<h2>Measured and predicted torque</h2>"
        '<p class="soft"><span class="key measured"></span> measured '
        '<span class="key model"></span> final model <span class="key rest"></span> their difference, on '
        f"a scale of its own. {first:.4g} s to {last:.4g} s.{gaps}</p>"
        '<p class="soft zooming" hidden>Drag to zoom, double-click for all; keys: arrows move, + and - zoom, '
        '0 shows all. <button type="button" data-go="in">zoom in</button> '
        '<button type="button" data-go="out">zoom out</button> '
        '<button type="button" data-go="all">show all</button> '
        '<output class="window"></output></p>'
        + "".join(panels)
        + f'<script type="application/json" class="data">{told}</script><script>{SCRIPT}</script></section>'
    )


def _panel(t, pair, rows, joint: str, unit: str, number: int) -> str:
    """One joint as SVG; its words and numbers stand beside it in letters of the page."""
    t, (measured, model) = t[rows], pair[rows].T
    low, high = float(np.nanmin(pair)), float(np.nanmax(pair))
    error = pair[:, 0] - pair[:, 1]
    most = float(np.nanmax(np.abs(error)))
    across = (t - t[0]) / (t[-1] - t[0]) * _WIDTH
    scale = _TOP / max(high - low, 1e-12)
    height = _TOP + _GAP + _LOW
    middle = _TOP + _GAP + 0.5 * _LOW
    lines = [
        ("measured", (high - measured) * scale),
        ("model", (high - model) * scale),
        ("rest", middle - (measured - model) * 0.5 * _LOW / max(most, 1e-12)),
    ]
    drawn = "".join(f'<path class="{name}" d="{_path(across, y)}"/>' for name, y in lines)
    rms = float(np.sqrt(np.nanmean(error**2)))
    words = (
        f"{joint}: torque from {low:.4g} to {high:.4g} {unit}, difference of model and measurement "
        f"{rms:.3g} {unit} RMS, {most:.3g} {unit} at most"
    )
    return (
        f'<figure class="signal" tabindex="0" data-joint="{number}"><figcaption><b>{escape(joint)}</b> '
        f"{low:.4g} to {high:.4g} {escape(unit)}; difference {rms:.3g} RMS, {most:.3g} at most"
        f'<output data-unit="{escape(unit)}"></output></figcaption>'
        f'<svg viewBox="0 0 {_WIDTH:g} {height:g}" preserveAspectRatio="none" role="img">'
        f"<title>{escape(words)}</title>"
        f'<line class="zero" x1="0" x2="{_WIDTH:g}" y1="{middle:g}" y2="{middle:g}"/>{drawn}'
        f'<line class="at" y1="0" y2="{height:g}" visibility="hidden"/>'
        f'<rect class="chosen" y="0" height="{height:g}" width="0" visibility="hidden"/></svg></figure>'
    )


def _path(x: np.ndarray, y: np.ndarray) -> str:
    """A line that ends before what is not known and begins anew behind it."""
    known = np.isfinite(y)
    begins = known & ~np.append(False, known[:-1])
    return " ".join(
        f"{'M' if new else 'L'}{a:.1f},{b:.1f}"
        for a, b, new in zip(x[known], y[known], begins[known], strict=True)
    )


def _listed(values: np.ndarray) -> list[float | None]:
    return [float(f"{x:.{_DIGITS}g}") if np.isfinite(x) else None for x in values]
