"""Search quality at equal evaluations, ours beside the peers, on shifted and rotated problems.

    python -m benchmarks.optimizers [--fast] [--runs 6] [--instances 101 102 103 104 105] [--dims 4 13 30]
                                    [--budget 200] [--cap 5000] [--only PATTERN] [--again PATTERN]

Every solver makes ``runs`` runs on every instance (shift and rotation) of every problem, 30 in all, each
with min(budget * D, cap) evaluations. A finished line of results is written at once as a JSON line and not
computed again by the next call, except for solvers that match ``--again``. Then follow tables of medians
with quartiles, mean ranks, rank tests against the best peer of the same name, and a performance profile.
"""

import argparse
import json
import re
import sys
import time
from pathlib import Path
from typing import Any

import jax
import numpy as np

jax.config.update("jax_enable_x64", True)

from benchmarks import optimizer_tables as tables  # noqa: E402
from benchmarks.problems import PROBLEMS, instance  # noqa: E402
from benchmarks.solvers import solvers  # noqa: E402
from benchmarks.timing import RESULTS, machine  # noqa: E402

NEEDS = ("evosax", "pyswarms", "pymoo", "mealpy")
TAKES = "an hour for all solvers in 4, 13 and 30 dimensions; --fast minutes"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fast", action="store_true", help="4 dimensions, few runs and problems")
    parser.add_argument("--runs", type=int, default=6, help="runs on each instance")
    parser.add_argument("--instances", type=int, nargs="+", default=[101, 102, 103, 104, 105])
    parser.add_argument("--dims", type=int, nargs="+", default=[4, 13, 30])
    parser.add_argument("--budget", type=int, default=200, help="evaluations per dimension")
    parser.add_argument("--cap", type=int, default=5000, help="most evaluations of a run")
    parser.add_argument("--only", default="", help="solvers whose label matches this pattern")
    parser.add_argument("--again", default="(?!)", help="compute these solvers anew")
    options = parser.parse_args()
    options.problems = tuple(PROBLEMS)
    if options.fast:
        options.problems, options.dims = ("sphere", "rastrigin"), [4]
        options.runs, options.instances = 2, options.instances[:2]

    RESULTS.mkdir(exist_ok=True)
    path = RESULTS / ("optimizers_fast.jsonl" if options.fast else "optimizers.jsonl")
    run(path, options)
    rows = list(load(path, options).values())
    print("results:", path)
    print(tables.rules({label: solver.rule for label, solver in solvers().items()}))
    print(tables.medians(rows))
    print(tables.ranks(rows))
    print(tables.tests(rows))
    print("profile:", tables.profile(rows, path.with_suffix(".png")))


def run(path: Path, options: argparse.Namespace) -> None:
    """Solve everything with everything that has no line of results yet."""
    for label, solver in solvers().items():
        if not re.search(options.only, label):
            continue
        known = {} if re.search(options.again, label) else load(path, options)
        tasks = [(dims, problem) for dims in options.dims for problem in options.problems]
        tasks = [task for task in tasks if (label, *task) not in known]
        try:
            solve = solver.build() if tasks else None
        except ImportError as error:
            print(f"{label}: not installed ({error})", file=sys.stderr)
            continue
        for dims, problem in tasks:
            begin = time.perf_counter()
            budget = min(options.budget * dims, options.cap)
            values = [
                solve(problem, instance(dims, k), budget, 1000 * k + np.arange(options.runs))
                for k in options.instances
            ]
            row = dict(solver=label, families=solver.families, problem=problem, dims=dims)
            row |= _settings(options, dims) | dict(seconds=time.perf_counter() - begin)
            row |= dict(machine=machine(), values=np.concatenate(values).tolist())
            with path.open("a") as file:
                file.write(json.dumps(row) + "\n")
        if tasks:
            print(f"{label}: done", file=sys.stderr, flush=True)


def load(path: Path, options: argparse.Namespace) -> dict[tuple, dict[str, Any]]:
    """Lines made with these settings, the newest of each (solver, dims, problem)."""
    lines = path.read_text().splitlines() if path.exists() else []
    found = {}
    for row in map(json.loads, lines):
        if row["dims"] in options.dims and _settings(options, row["dims"]).items() <= row.items():
            found[row["solver"], row["dims"], row["problem"]] = row
    return found


def _settings(options, dims):
    budget = min(options.budget * dims, options.cap)
    return dict(evaluations=budget, runs=options.runs, instances=options.instances)


if __name__ == "__main__":
    main()
