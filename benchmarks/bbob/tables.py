"""Shares of targets reached, by dimension and group of functions, and their growth as pictures."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.bbob.problems import GROUPS, TARGETS

Cell = dict[str, Any]


def share(cells: Sequence[Cell], budget: float = np.inf) -> float:
    """Share of (function, instance, target) that were reached within ``budget`` evaluations."""
    hits = np.concatenate([cell["hits"] for cell in cells])
    return float(np.mean((hits > 0) & (hits <= budget)))


def table(cells: Sequence[Cell]) -> str:
    """Markdown: a table for each dimension and budget, the best solver first."""
    lines = []
    settings = sorted({(cell["dims"], cell["budget"]) for cell in cells})
    for dims, budget in settings:
        here = [c for c in cells if (c["dims"], c["budget"]) == (dims, budget)]
        instances = sorted({i for c in here for i in c["instances"]})
        lines += [
            f"\n### {dims}-D, {budget} D evaluations, {len(instances)} instances",
            f"\n| solver | all | {' | '.join(GROUPS)} |",
            "|---" * (len(GROUPS) + 2) + "|",
        ]
        rows = []
        for solver in dict.fromkeys(c["solver"] for c in here):
            own = [c for c in here if c["solver"] == solver]
            parts = [[c for c in own if c["function"] in group] for group in GROUPS.values()]
            rows.append((solver, share(own), *(share(p) if p else np.nan for p in parts)))
        for solver, *shares in sorted(rows, key=lambda row: -row[1]):
            lines.append(f"| {solver} | {' | '.join(f'{s:.3f}' for s in shares)} |")
    return "\n".join(lines)


def picture(cells: Sequence[Cell], path: Path) -> Path:
    """Share of targets over evaluations / D, a panel for each dimension; the largest budget counts."""
    from matplotlib.figure import Figure

    panels = sorted({cell["dims"] for cell in cells})
    figure = Figure(figsize=(5.5 * len(panels), 4.2), layout="constrained")
    axes = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
    for axis, dims in zip(axes, panels, strict=True):
        here = [c for c in cells if c["dims"] == dims]
        budget = max(c["budget"] for c in here)
        here = [c for c in here if c["budget"] == budget]
        grid = np.logspace(0.0, np.log10(budget), 200)
        for number, solver in enumerate(dict.fromkeys(c["solver"] for c in here)):
            hits = np.concatenate([c["hits"] for c in here if c["solver"] == solver])
            times = np.sort(hits[hits > 0]) / dims
            line = np.searchsorted(times, grid, side="right") / hits.size
            style = "-" if solver.startswith("jaxswarm") else "--"
            axis.semilogx(grid, line, style, color=f"C{number % 10}", label=solver)
        axis.set(title=f"{dims}-D, {TARGETS.size} targets", xlabel="evaluations / D", ylim=(0, 1))
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("share of functions, instances, targets")
    axes[-1].legend(fontsize=7, loc="upper left")
    figure.savefig(path, dpi=130)
    return path
