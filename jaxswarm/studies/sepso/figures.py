"""Pictures of the SEPSO study."""

import numpy as np
from matplotlib.figure import Figure

from jaxswarm import plots
from jaxswarm.studies.sepso.search import GENETIC, OURS, PARTICLES, SEPSO, SPSO, Runs

_STYLES = {
    "SPSO": (plots.RESIDUAL, "-"),
    "SPSO (w falls)": (plots.RESIDUAL, "--"),
    "GA": (plots.ACCENT, "-"),
    "textbook GA": (plots.ACCENT, "--"),
    "SEPSO R1": (plots.MODEL, "-"),
    "SEPSO R2": (plots.MODEL, "--"),
    "SEPSO R3": (plots.MODEL, ":"),
    OURS: ("k", "-"),
}

# What the picture shows, for those who do not see it.
WORDS = (
    "Output error over the evaluations, median and quartiles of the runs: the paper's contestants, and beside "
    "them other optimizers where they were asked."
)


def convergence(found: dict[str, Runs], title: str) -> Figure:
    """Best cost over evaluations, median and quartile band: the paper's contestants, the yardsticks."""
    contest = [n for n in found if n in (*SPSO, *GENETIC, *SEPSO)]
    yardsticks = [n for n in found if n not in contest]
    groups = [g for g in (contest, yardsticks and ["SPSO", *yardsticks]) if g]
    figure, axes = plots.panels(1, len(groups), 5.2 * len(groups), 4.0)
    for axis, names in zip(axes, groups, strict=True):
        for k, name in enumerate(names):
            low, middle, high = np.quantile(found[name].history, [0.25, 0.5, 0.75], axis=0)
            evaluations = PARTICLES * np.arange(1, len(middle) + 1)
            color, line = _STYLES.get(name, (f"C{k}", "-"))
            axis.semilogy(evaluations, middle, line, color=color, lw=1.3, label=name)
            axis.fill_between(evaluations, low, high, color=color, alpha=0.1, lw=0)
        axis.set_xlabel("evaluations")
        axis.legend(framealpha=0.7, edgecolor="none", fontsize=7, ncols=2)
    axes[0].set_ylabel("output error; median and quartiles")
    figure.suptitle(title, fontsize=11)
    return figure
