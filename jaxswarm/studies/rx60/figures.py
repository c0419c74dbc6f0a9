"""Pictures of the RX60 study; functions of its results that return figures."""

import numpy as np
from matplotlib.figure import Figure

from jaxswarm import plots
from jaxswarm.studies.rx60 import paper
from jaxswarm.studies.rx60.data import Experiment
from jaxswarm.studies.rx60.search import Search

COLORS = {"gpso": plots.RESIDUAL, "aelspso": plots.MODEL}

# What they show, for those who do not see them.
WORDS = {
    "convergence": "Fitness over the steps without and with noise: median and quartiles of the runs of both "
    "schemes, the paper's values dotted, least squares dashed.",
    "null_space": "Scatter of the runs: five parameters that the data cannot see, with the paper's values, and "
    "the combinations that it can see, on a logarithmic scale.",
    "cause": "Median noise-free fitness of every variant of AELSPSO for both accelerations; GPSO dashed.",
    "sensitivity": "Median noise-free fitness over the acceleration for several widths of the bounds, 24 "
    "particles and 200 steps; the paper's value dotted.",
    "loop": "Error on unseen motion by joint: GPSO, AELSPSO, the declared model and the model after the loop, "
    "for every effect that was not declared.",
}


def torque(measured: Experiment, theta: np.ndarray, title: str) -> Figure:
    """The paper's torque comparison: validation torque, and the estimate's."""
    joints, units = ("joint 1", "joint 2", "joint 3"), ("N m",) * 3
    every = slice(None, None, max(1, len(measured.t) // 700))
    predicted = measured.columns @ theta
    return plots.torque_overlay(
        measured.t[every], measured.tau[every], predicted[every], joints, units, title
    )


def convergence(searches: dict[tuple[str, str], Search], optimum: dict[str, float]) -> Figure:
    """Best fitness per step: median and quartile band of the runs, with the least-squares value."""
    figure, axes = plots.panels(1, 2, 10.0, 3.8)
    for axis, case in zip(axes, ("clean", "noisy"), strict=True):
        for name, color in COLORS.items():
            low, middle, high = np.quantile(searches[name, case].history, [0.25, 0.5, 0.75], axis=0)
            steps = np.arange(1, len(middle) + 1)
            axis.semilogy(steps, middle, color=color, label=name.upper())
            axis.fill_between(steps, low, high, color=color, alpha=0.2, lw=0)
            axis.axhline(paper.FBEST[name, case][0], color=color, lw=0.8, ls=":")
        if case == "noisy":
            axis.axhline(optimum[case], color="k", lw=0.8, ls="--", label="least squares")
        axis.set_xlabel("step")
        axis.set_title(f"{case}; dotted: the paper's fbest", fontsize=9)
        axis.legend(frameon=False, fontsize=8)
    axes[0].set_ylabel("fitness [N m]")
    return figure


def null_space(raw: np.ndarray, base: np.ndarray, labels: tuple[str, ...]) -> Figure:
    """Spread over the runs: five raw parameters that the data cannot see, and their combinations."""
    figure, axes = plots.panels(1, 2, 10.0, 3.4)
    names = ("Czz1", "Axx2", "Byy2", "Axx3", "Byy3")
    chosen = [paper.NAMES.index(n) for n in names]
    axes[0].bar(names, raw[:, chosen].std(axis=0, ddof=1), color=plots.MODEL)
    printed = np.array(paper.STD["gpso", "clean"])[chosen]
    axes[0].plot(names, printed, "k_", ms=18, label="paper")
    axes[0].legend(frameon=False)
    axes[0].set_title("standard deviation over the runs, raw [kg m^2]", fontsize=9)
    shown = [k for k, label in enumerate(labels) if "+" in label or " - " in label]
    axes[1].bar(
        [labels[k] for k in shown], base[:, shown].std(axis=0, ddof=1), color=plots.RESIDUAL
    )
    axes[1].set_yscale("log")
    axes[1].tick_params(axis="x", labelsize=7)
    axes[1].set_title("the same runs in base combinations (log scale)", fontsize=9)
    return figure


def cause(rows: list[dict]) -> Figure:
    """Median fbest of every variant of AELSPSO for both accelerations."""
    figure, (axis,) = plots.panels(1, 1, 9.0, 4.2)
    names = list(dict.fromkeys(r["variant"] for r in rows))
    for k, c in enumerate(sorted({r["c"] for r in rows})):
        own = {r["variant"]: r for r in rows if r["c"] == c}
        heights = [own[n]["fbest_median"] for n in names]
        color = (plots.MODEL, plots.RESIDUAL)[k % 2]
        axis.barh(np.arange(len(names)) + 0.4 * k, heights, 0.38, color=color, label=f"c = {c:g}")
        axis.axvline(own[names[0]]["gpso_median"], color=color, lw=0.9, ls="--")
    axis.set_yticks(np.arange(len(names)) + 0.2, names, fontsize=8)
    axis.set_xscale("log")
    axis.invert_yaxis()
    axis.set_xlabel("median noise-free fbest [N m]; dashed: GPSO of the same c")
    axis.legend(frameon=False)
    return figure


def sensitivity(rows: list[dict]) -> Figure:
    """Median fbest over c and bounds, for the middle swarm size and the shortest budget near the paper's."""
    figure, axes = plots.panels(1, 2, 10.0, 3.6)
    for axis, name in zip(axes, COLORS, strict=True):
        own = [
            r for r in rows if r["scheme"] == name and r["particles"] == 24 and r["steps"] == 200
        ]
        stretches = sorted({r["bounds"] for r in own})
        for k, stretch in enumerate(stretches):
            line = [r for r in own if r["bounds"] == stretch]
            axis.semilogy(
                [r["c"] for r in line],
                [r["fbest_median"] for r in line],
                "o-",
                color=(plots.MODEL, plots.RESIDUAL, plots.ACCENT, plots.MEASURED, "k")[k % 5],
                label=f"bounds x {stretch:g}",
            )
        axis.axhline(paper.FBEST[name, "clean"][0], color="k", ls=":", lw=0.9)
        axis.set_xlabel("c1 = c2")
        axis.set_title(f"{name.upper()}, 24 particles, 200 steps; dotted: paper", fontsize=9)
        axis.legend(frameon=False, fontsize=7)
    axes[0].set_ylabel("median noise-free fbest [N m]")
    return figure


def loop(rows: list[dict]) -> Figure:
    """RMS error on unseen motion per joint: both schemes, the declared model, the model after the loop."""
    figure, axes = plots.panels(1, len(rows), 3.6 * len(rows), 3.6)
    for axis, row in zip(axes, rows, strict=True):
        bars = {
            "GPSO": (row["gpso"]["rms"], COLORS["gpso"]),
            "AELSPSO": (row["aelspso"]["rms"], COLORS["aelspso"]),
            "declared model": (row["loop"]["before"], plots.MEASURED),
            "after the loop": (row["loop"]["after"], plots.ACCENT),
        }
        for k, (label, (heights, color)) in enumerate(bars.items()):
            axis.bar(np.arange(3) + 0.2 * (k - 1.5), heights, 0.19, color=color, label=label)
        axis.set_xticks(range(3), ("joint 1", "joint 2", "joint 3"))
        axis.set_title(f"undeclared: {row['hidden']}", fontsize=9)
        axis.set_yscale("log")
    axes[0].set_ylabel("RMS on unseen motion [N m]")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False, fontsize=8)
    return figure
