"""Search quality on the 24 functions of BBOB, ours beside other libraries (python -m pip install '.[bbob]').

    python -m benchmarks.bbob [--dims 5 20] [--budgets 1000] [--instances 101-105] [--functions 1-24]
                              [--only PATTERN] [--again PATTERN] [--tables] [--out FOLDER]

A cell is a solver, a dimension, a budget (evaluations / D) and a function, on all instances. It is written
whole to a file of its own when it is done and not computed again by the next call, except for solvers that
match ``--again``. Then follow the share of COCO's 51 targets that were reached, by group of functions, and
a picture of how it grows. Reported are instances 101-115; defaults were chosen on 1-15.
"""

import argparse
import json
import os
import re
import sys
import time
from pathlib import Path
from typing import Any

import jax
import numpy as np

jax.config.update("jax_enable_x64", True)

from benchmarks.bbob import ours, rivals, tables  # noqa: E402
from benchmarks.bbob.problems import FUNCTIONS, Record, Single, bbob  # noqa: E402
from benchmarks.timing import RESULTS  # noqa: E402

NEEDS = ("ioh", "cma", "pymoo", "nevergrad", "pyswarms", "evosax")
TAKES = "minutes a solver for --dims 5 20 --budgets 1000; days for everything"


def numbers(text: str) -> list[int]:
    """Read ``3`` or ``1-5``."""
    first, _, last = text.partition("-")
    return list(range(int(first), int(last or first) + 1))


def main(arguments: list[str] | None = None) -> None:
    """Compute what has no file yet and print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--dims", type=int, nargs="+", default=[2, 5, 20, 40])
    parser.add_argument("--budgets", type=int, nargs="+", default=[100, 1000, 10_000])
    parser.add_argument("--instances", type=numbers, default=numbers("101-115"))
    parser.add_argument("--functions", type=numbers, nargs="+", default=[list(FUNCTIONS)])
    parser.add_argument("--only", default="", help="solvers whose label matches this pattern")
    parser.add_argument("--again", default="(?!)", help="compute these solvers anew")
    parser.add_argument("--tables", action="store_true", help="show what is there, compute nothing")
    parser.add_argument("--out", type=Path, default=RESULTS / "bbob")
    options = parser.parse_args(arguments)
    options.functions = sorted({f for part in options.functions for f in part})

    options.out.mkdir(parents=True, exist_ok=True)
    if not options.tables:
        for dims in options.dims:
            for budget in options.budgets:
                run(options, dims, budget)
    cells = [
        json.loads(path.read_text())
        for dims in options.dims
        for budget in options.budgets
        for label in chosen(options)
        for function in options.functions
        if (path := place(options, label, dims, budget, function)).exists()
    ]
    if not cells:
        print("no results for these options", file=sys.stderr)
        return
    text = tables.table(cells)
    (options.out / "shares.md").write_text(text + "\n")
    print(text)
    print("picture:", tables.picture(cells, options.out / "ecdf.png"))


def chosen(options: argparse.Namespace) -> list[str]:
    """Labels that match ``--only``."""
    return [label for label in (*ours.OURS, *rivals.RIVALS) if re.search(options.only, label)]


def place(options: argparse.Namespace, label: str, dims: int, budget: int, function: int) -> Path:
    """File of a cell."""
    first, last = options.instances[0], options.instances[-1]
    folder = re.sub(r"[^A-Za-z0-9_]+", "-", label).strip("-")
    return options.out / folder / f"d{dims}_b{budget}_f{function:02}_i{first}-{last}.json"


def run(options: argparse.Namespace, dims: int, budget: int) -> None:
    """Compute the cells of one dimension and budget that are missing."""
    for label in chosen(options):
        again = re.search(options.again, label)
        left = [
            function
            for function in options.functions
            if again or not place(options, label, dims, budget, function).exists()
        ]
        if not left:
            continue
        begin = time.perf_counter()
        try:
            solve = run_ours if label in ours.OURS else run_rival
            solve(options, label, dims, budget, left)
        except ImportError as error:
            print(f"{label}: not installed ({error})", file=sys.stderr)
            continue
        seconds = time.perf_counter() - begin
        print(f"{label}, {dims}-D, {budget} D: {seconds:.0f} s", file=sys.stderr, flush=True)


def run_ours(
    options: argparse.Namespace, label: str, dims: int, budget: int, functions: list[int]
) -> None:
    """All functions and instances at once."""
    pairs = [(f, i) for f in functions for i in options.instances]
    record = Record([bbob(f, i, dims) for f, i in pairs], budget * dims)
    seeds = np.array([1000 * f + i for f, i in pairs])
    ours.solve(ours.OURS[label], record, dims, seeds)
    hits = record.hits.reshape(len(functions), len(options.instances), -1)
    for function, cell in zip(functions, hits, strict=True):
        write(options, label, dims, budget, function, cell)


def run_rival(
    options: argparse.Namespace, label: str, dims: int, budget: int, functions: list[int]
) -> None:
    """One run after the other, a file a function."""
    search = rivals.RIVALS[label]()
    for function in functions:
        hits = []
        for instance in options.instances:
            single = Single(bbob(function, instance, dims), budget * dims)
            rivals.solve(search, single, dims, budget * dims, 1000 * function + instance)
            hits.append(single.record.hits[0])
        write(options, label, dims, budget, function, np.array(hits))


def write(
    options: argparse.Namespace, label: str, dims: int, budget: int, function: int, hits: Any
) -> None:
    """Write a cell so that it is there whole or not at all."""
    path = place(options, label, dims, budget, function)
    path.parent.mkdir(parents=True, exist_ok=True)
    cell = dict(solver=label, dims=dims, budget=budget, function=function)
    cell |= dict(instances=options.instances, hits=hits.tolist())
    part = path.with_suffix(".part")
    part.write_text(json.dumps(cell))
    os.replace(part, path)


if __name__ == "__main__":
    main()
