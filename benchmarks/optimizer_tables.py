"""Tables, rank tests and the picture of the search-quality benchmark, from its lines of results."""

from pathlib import Path

import numpy as np
from scipy import stats

OURS = "jaxswarm"
FLOOR = 1e-8  # errors below count as solved, and as equal


def rules(rule_of: dict[str, str]) -> str:
    """What each solver really runs."""
    return "\n".join(f"{label:<30} {rule}" for label, rule in rule_of.items())


def medians(rows) -> str:
    """Medians and quartiles of the error, one line a solver, one column a problem."""
    lines = []
    for dims in sorted({row["dims"] for row in rows}):
        here = [row for row in rows if row["dims"] == dims]
        names = list(dict.fromkeys(row["problem"] for row in here))
        lines.append(f"\nD = {dims}, {here[0]['evaluations']} evaluations: median [quartiles]")
        lines.append(f"{'':<30}" + "".join(f"{name:>27}" for name in names))
        for label in _labels(here):
            cells = []
            for name in names:
                values = _errors(here, label, (name, dims))
                low, middle, high = (
                    np.percentile(values, [25, 50, 75]) if values.size else [np.nan] * 3
                )
                cells.append(f"{middle:>9.2e} [{low:.1e}, {high:.1e}]".rjust(27))
            lines.append(f"{label:<30}" + "".join(cells))
    return "\n".join(lines)


def ranks(rows) -> str:
    """Mean rank of the medians, all tasks and each dimension (1 is best)."""
    labels, tasks = _labels(rows), _tasks(rows)
    table = [[_median(rows, label, task) for task in tasks] for label in labels]
    rank = stats.rankdata(table, axis=0)
    sizes = sorted({dims for _, dims in tasks})
    columns = [rank.mean(axis=1)]
    columns += [rank[:, [dims == d for _, dims in tasks]].mean(axis=1) for d in sizes]
    lines = ["\nmean rank of the medians: all" + "".join(f"  D = {d:<3}" for d in sizes)]
    for i in np.argsort(columns[0]):
        lines.append("".join(f"{column[i]:8.2f}" for column in columns) + "  " + labels[i])
    return "\n".join(lines)


def tests(rows) -> str:
    """Ours against the best peer of each family, task by task.

    A two-sided Mann-Whitney test a task, Holm-corrected over the tasks; A is the chance that a run of ours
    ends lower than one of the peer (Vargha and Delaney), 0.5 for equals.
    """
    lines = [
        "\nours against the best peer of the family on each task: better / alike / worse (Holm, p < 0.05),",
        "median A over the tasks = chance that a run of ours ends lower; tasks lost, with A, to whom",
    ]
    for family in dict.fromkeys(name for row in rows for name in row["families"]):
        labels = _labels(row for row in rows if family in row["families"])
        peers = [label for label in labels if not label.startswith(OURS)]
        for mine in (label for label in labels if label.startswith(OURS) and peers):
            lines.append(f"{family:<18} " + _against(rows, mine, peers))
    return "\n".join(lines)


def _against(rows, mine, peers):
    found = []
    for task in _tasks([row for row in rows if row["solver"] == mine]):
        there = [peer for peer in peers if _errors(rows, peer, task).size]
        if not there:
            continue
        best = min(there, key=lambda peer: _median(rows, peer, task))
        own, other = _errors(rows, mine, task), _errors(rows, best, task)
        test = stats.mannwhitneyu(own, other)
        p = 1.0 if np.ptp(np.concatenate([own, other])) == 0.0 else test.pvalue
        found.append((p, 1.0 - test.statistic / (own.size * other.size), task, best))
    wins, losses, running = 0, [], 0.0
    for i, (p, chance, (problem, dims), best) in enumerate(sorted(found)):
        running = max(running, p * (len(found) - i))
        if running < 0.05 and chance > 0.5:
            wins += 1
        elif running < 0.05:
            losses.append(f"{problem} D={dims} ({chance:.2f}, {best})")
    middle = np.median([chance for _, chance, *_ in found])
    alike = len(found) - wins - len(losses)
    return f"{mine:<26} {wins:>3} / {alike:>3} / {len(losses):>3}   A {middle:.2f}   {'; '.join(losses)}"


PANELS = {
    "global-best swarms": ("PSO", "PSO, rule of gpso", "PSO, rule of spso"),
    "other swarms": ("PSO, local best", "PSO, adaptive", "CLPSO", "sepso", "spso2011"),
    "differential evolution": ("DE", "SHADE", "L-SHADE"),
    "genetic, CMA-ES, random": ("GA", "textbook GA", "CMA-ES", "random_search"),
}


def profile(rows, path: Path) -> Path:
    """Picture: share of runs whose error is within a factor of the best median of the task."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(
        2, 2, figsize=(12, 9), sharex=True, sharey=True, layout="constrained"
    )
    labels, tasks = _labels(rows), _tasks(rows)
    best = {task: min(_median(rows, label, task) for label in labels) for task in tasks}
    factors = np.logspace(0, 8, 200)
    for axis, (title, families) in zip(axes.flat, PANELS.items(), strict=True):
        members = _labels(row for row in rows if set(row["families"]) & set(families))
        for i, label in enumerate(members):
            ratios = np.concatenate([_errors(rows, label, task) / best[task] for task in tasks])
            share = (ratios[None] <= factors[:, None]).mean(axis=1)
            style = "-" if label.startswith(OURS) else "--"
            axis.semilogx(
                factors, share, style, color=plt.cm.tab20(2 * i % 20 + i // 10), label=label
            )
        axis.set(title=title, ylim=(0, 1))
        axis.grid(alpha=0.3)
        axis.legend(fontsize=7, loc="upper left" if axis is axes[0, 0] else "best")
    figure.supxlabel("error over the best median of the task (all solvers)")
    figure.supylabel("share of runs")
    figure.savefig(path, dpi=130)
    plt.close(figure)
    return path


def _labels(rows):
    return list(dict.fromkeys(row["solver"] for row in rows))


def _tasks(rows):
    """Problems and dimensions that every solver of the rows has solved."""
    solved: dict[str, set] = {}
    for row in rows:
        solved.setdefault(row["solver"], set()).add((row["problem"], row["dims"]))
    everywhere = set.intersection(*solved.values())
    return [
        task
        for task in dict.fromkeys((r["problem"], r["dims"]) for r in rows)
        if task in everywhere
    ]


def _errors(rows, label, task):
    for row in rows:
        if row["solver"] == label and (row["problem"], row["dims"]) == task:
            return np.maximum(row["values"], FLOOR)
    return np.array([])


def _median(rows, label, task):
    return float(np.median(_errors(rows, label, task)))
