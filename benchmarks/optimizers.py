"""Search quality at equal evaluations, ours beside the peers, on shifted and rotated problems.

    python -m benchmarks.optimizers [--fast] [--seeds 30] [--budget 300] [--dims 4 13 30]
                                   [--only PATTERN] [--join FILE ...] [--out NAME]

Writes one JSON line for each solver, problem and dimension, a performance profile, and prints medians
with quartiles, mean ranks, and for each family of the same name a rank test of ours against the best
peer (two-sided Mann-Whitney, Holm-corrected within the family).
"""

import argparse
import json
import re
import sys
import time
from typing import Any

import jax
import numpy as np
from scipy import stats

jax.config.update("jax_enable_x64", True)

from benchmarks.problems import PROBLEMS, instance  # noqa: E402
from benchmarks.solvers import solvers  # noqa: E402
from benchmarks.timing import RESULTS, machine, write_lines  # noqa: E402


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fast", action="store_true", help="4 dimensions, few seeds and problems")
    parser.add_argument("--seeds", type=int, default=30)
    parser.add_argument("--budget", type=int, default=300, help="evaluations per dimension")
    parser.add_argument("--dims", type=int, nargs="+", default=[4, 13, 30])
    parser.add_argument("--only", default="", help="solvers whose label matches this pattern")
    parser.add_argument("--join", nargs="*", default=[], help="add the rows of earlier runs")
    parser.add_argument("--out", default="optimizers.jsonl", help="name of the file of rows")
    options = parser.parse_args()
    problems = tuple(PROBLEMS)
    if options.fast:
        options.seeds, options.dims, problems = 5, [4], ("sphere", "rastrigin")

    rows = run(problems, options)
    rows += [json.loads(line) for path in options.join for line in open(path)]
    print("written to", write_lines(options.out, rows))
    print(table(rows))
    print(ranks(rows))
    print(rank_tests(rows))
    print("profile:", profile(rows))


def run(problems, options) -> list[dict[str, Any]]:
    """Solve everything with everything."""
    rows = []
    for label, (family, build) in solvers().items():
        if not re.search(options.only, label):
            continue
        try:
            solve = build()
        except ImportError as error:
            print(f"{label}: not installed ({error})", file=sys.stderr)
            continue
        begin = time.perf_counter()
        for dims in options.dims:
            for problem in problems:
                values = solve(problem, instance(dims), options.budget * dims, options.seeds)
                about = dict(solver=label, family=family, problem=problem, dims=dims)
                about |= dict(evaluations=options.budget * dims, machine=machine())
                rows.append(about | {"values": [float(v) for v in values]})
        write_lines(options.out, rows)  # an interrupted benchmark keeps what it has
        print(f"{label}: {time.perf_counter() - begin:.1f} s", file=sys.stderr)
    return rows


def table(rows) -> str:
    """Medians and quartiles of the error, one line a solver, one column a problem."""
    lines = []
    for dims in sorted({row["dims"] for row in rows}):
        here = [row for row in rows if row["dims"] == dims]
        names = list(dict.fromkeys(row["problem"] for row in here))
        lines.append(f"\nD = {dims}, {here[0]['evaluations']} evaluations: median [quartiles]")
        lines.append(f"{'':<30}" + "".join(f"{name:>27}" for name in names))
        for label in dict.fromkeys(row["solver"] for row in here):
            cells = []
            for name in names:
                values = _values(here, label, name)
                low, middle, high = np.percentile(values, [25, 50, 75])
                cells.append(f"{middle:>9.2e} [{low:.1e}, {high:.1e}]".rjust(27))
            lines.append(f"{label:<30}" + "".join(cells))
    return "\n".join(lines)


def ranks(rows) -> str:
    """Mean rank of the medians over all problems and dimensions (1 is best)."""
    labels = list(dict.fromkeys(row["solver"] for row in rows))
    medians = np.array([[_median(rows, label, key) for key in _tasks(rows)] for label in labels])
    mean = stats.rankdata(medians, axis=0).mean(axis=1)
    lines = [f"{mean[i]:6.2f}  {labels[i]}" for i in np.argsort(mean)]
    return "\nmean rank of the medians\n" + "\n".join(lines)


def rank_tests(rows) -> str:
    """Ours against the best peer of the same name, task by task."""
    lines = ["\nours against the best peer of the family: tasks better / alike / worse (p < 0.05)"]
    for family in dict.fromkeys(row["family"] for row in rows):
        labels = list(dict.fromkeys(r["solver"] for r in rows if r["family"] == family))
        peers = [label for label in labels if not label.startswith("jaxswarm")]
        for mine in (label for label in labels if label.startswith("jaxswarm") and peers):
            lines.append(_against([r for r in rows if r["solver"] in (mine, *peers)], mine, peers))
    return "\n".join(lines)


def _against(rows, mine, peers) -> str:
    tests = []
    for task in _tasks(rows):
        best = min(peers, key=lambda peer: _median(rows, peer, task))
        own, other = _at(rows, mine, task), _at(rows, best, task)
        # Below 1e-10 of the optimum there is nothing left to tell apart.
        own, other = np.maximum(own, 1e-10), np.maximum(other, 1e-10)
        same = np.all(own == other[0]) and np.all(other == other[0])
        test = stats.mannwhitneyu(own, other)
        lower = test.statistic < own.size * other.size / 2.0
        tests.append((1.0 if same else test.pvalue, lower, task, best))
    corrected, running = {}, 0.0
    for i, (p, _, task, _) in enumerate(sorted(tests, key=lambda test: test[0])):
        running = max(running, min(1.0, p * (len(tests) - i)))
        corrected[task] = running
    better = sum(corrected[task] < 0.05 and lower for _, lower, task, _ in tests)
    lost = [(task, peer) for _, lower, task, peer in tests if corrected[task] < 0.05 and not lower]
    alike = len(tests) - better - len(lost)
    told = "; ".join(f"{problem} D={dims} to {peer}" for (problem, dims), peer in lost)
    return f"{mine:<24} {better:>3} / {alike:>3} / {len(lost):>3}   {told}"


def profile(rows):
    """Picture: share of runs whose error is within a factor of the best median of the task."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(9, 6), layout="constrained")
    best = {
        task: max(1e-8, min(_median(rows, label, task) for label in {r["solver"] for r in rows}))
        for task in _tasks(rows)
    }
    factors = np.logspace(0, 8, 200)
    for i, label in enumerate(dict.fromkeys(row["solver"] for row in rows)):
        ratios = np.concatenate([_at(rows, label, task) / best[task] for task in best])
        share = (ratios[None] <= factors[:, None]).mean(axis=1)
        style = "-" if label.startswith("jaxswarm") else "--"
        axes.semilogx(factors, share, style, color=plt.cm.tab20(i % 20), label=label)
    axes.set(xlabel="error over best median of the task", ylabel="share of runs", ylim=(0, 1))
    axes.legend(fontsize=6, ncols=2)
    RESULTS.mkdir(exist_ok=True)
    path = RESULTS / "optimizers.png"
    figure.savefig(path, dpi=150)
    return path


def _tasks(rows):
    """Problems and dimensions that every solver of the rows has solved."""
    solved: dict[str, set] = {}
    for row in rows:
        solved.setdefault(row["solver"], set()).add((row["problem"], row["dims"]))
    everywhere = set.intersection(*solved.values())
    tasks = dict.fromkeys((row["problem"], row["dims"]) for row in rows)
    return [task for task in tasks if task in everywhere]


def _values(rows, label, problem):
    return next(r["values"] for r in rows if r["solver"] == label and r["problem"] == problem)


def _at(rows, label, task):
    found = (r for r in rows if r["solver"] == label and (r["problem"], r["dims"]) == task)
    return np.array(next(found)["values"])


def _median(rows, label, task):
    return float(np.median(_at(rows, label, task)))


if __name__ == "__main__":
    main()
