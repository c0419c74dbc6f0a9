"""Pictures of the SEPSO study."""

import numpy as np
from matplotlib.figure import Figure

from jaxswarm import plots
from jaxswarm.studies.sepso_search import PARTICLES, Runs

_COLORS = {"SPSO": plots.RESIDUAL, "GA": plots.ACCENT, "SEPSO R1": plots.MODEL}


def convergence(found: dict[str, Runs], title: str) -> Figure:
    """Best cost over evaluations: median and quartile band of the runs."""
    figure, (axis,) = plots.panels(1, 1, 8.0, 4.0)
    styles = ("-", "--", ":", "-.")
    for k, (name, runs) in enumerate(found.items()):
        low, middle, high = np.quantile(runs.history, [0.25, 0.5, 0.75], axis=0)
        evaluations = PARTICLES * np.arange(1, len(middle) + 1)
        color = _COLORS.get(name, f"C{k % 10}")
        axis.semilogy(evaluations, middle, styles[k % 4], color=color, lw=1.2, label=name)
        axis.fill_between(evaluations, low, high, color=color, alpha=0.12, lw=0)
    axis.set_xlabel("evaluations")
    axis.set_ylabel("output error")
    axis.legend(frameon=False, fontsize=7, ncols=2)
    figure.suptitle(title, fontsize=11)
    return figure
