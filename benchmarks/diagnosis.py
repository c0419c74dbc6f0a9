"""Logs with an undeclared effect: is it named, on its joint, and is nothing else?

    python -m benchmarks.diagnosis practice|suite|pairs|real [--fast] [--only NAME,...] [--share K/N]
    python -m benchmarks.diagnosis discover|mechanisms|rivals|limits [--fast] [--share K/N]
    python -m benchmarks.diagnosis worlds --help

``practice``: the cases of another simulator under ``cases/`` (``JAXSWARM_DATA``, default ``../shared``);
``suite``: simulated logs with one effect, see :mod:`benchmarks.diagnosis_cases`; ``pairs``: with two or
three, see :mod:`benchmarks.diagnosis_pairs`; ``real``: measured robots; ``discover``: laws drawn from the
grammar of formulas, see :mod:`benchmarks.diagnosis_discover`; ``mechanisms``: magnets, cables, linkages,
brakes, see :mod:`benchmarks.diagnosis_mechanisms`; ``rivals``: the same given to PySINDy and gplearn, see
:mod:`benchmarks.diagnosis_rivals`; ``limits``: effects at multiples of the visible ratio, see
:mod:`benchmarks.diagnosis_limits`; ``worlds``: arms, controllers and
loggers simulated by MuJoCo, see :mod:`benchmarks.worlds`. Rows go to
``benchmarks/results/`` as JSON lines, tables beside them. The suite goes through its cases in a random
order, so that a part of it says what the whole would; it skips what is finished already, and several
processes may share it (``--share``).
"""

import argparse
import json
import os
import sys

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: see jaxswarm.runtime

import jax
import numpy as np

from benchmarks.timing import RESULTS, write_lines

NEEDS = ("data",)
TAKES = "practice 5 minutes, real 5, pairs 30, suite 90 on one core; --fast minutes"


def practice(only: set[str]) -> None:
    from benchmarks.diagnosis_practice import data_root, practice_case, practice_table

    rows = []
    for folder in sorted((data_root() / "cases").glob("p*")):
        if only and folder.name not in only:
            continue
        rows.append(practice_case(folder))
        print(json.dumps(rows[-1]), flush=True)
    if not only:
        write_lines("diagnosis_practice.jsonl", rows)
        (RESULTS / "diagnosis_practice.md").write_text(practice_table(rows))
    print(practice_table(rows))


def real(only: set[str]) -> None:
    from benchmarks.diagnosis_practice import REAL, real_case

    rows = []
    for name in REAL:
        if not only or name in only:
            rows.append(real_case(name))
            print(json.dumps(rows[-1]), flush=True)
    if not only:
        write_lines("diagnosis_real.jsonl", rows)


def pairs(fast: bool) -> None:
    from benchmarks.diagnosis_pairs import pairs_table, run_pairs

    rows = []
    for number in range(4 if fast else 40):
        rows.append(run_pairs(number))
        print(json.dumps(rows[-1]), flush=True)
    if not fast:
        write_lines("diagnosis_pairs.jsonl", rows)
        (RESULTS / "diagnosis_pairs.md").write_text(pairs_table(rows))
    print(pairs_table(rows))


def suite(fast: bool, only: set[str], share: str) -> None:
    from benchmarks.diagnosis_cases import all_cases
    from benchmarks.diagnosis_suite import run_case
    from benchmarks.diagnosis_tables import summarize

    path = RESULTS / ("diagnosis_suite_fast.jsonl" if fast else "diagnosis_suite.jsonl")
    rows = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    done = {row["case"] for row in rows}
    cases = all_cases(fast)
    own, count = map(int, share.split("/"))
    for number in np.random.default_rng(0).permutation(len(cases))[own - 1 :: count]:
        case = cases[number]
        if case.name in done or (only and case.effect not in only):
            continue
        rows.append(run_case(case))
        print(json.dumps(rows[-1]), flush=True)
        with path.open("a") as file:
            file.write(json.dumps(rows[-1]) + "\n")
    rows = [json.loads(line) for line in path.read_text().splitlines()]
    print(summarize(rows, path.with_suffix("")))


def main() -> None:
    if sys.argv[1:2] == ["worlds"]:
        from benchmarks.worlds.command import main as worlds

        return worlds(sys.argv[2:])
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "part",
        choices=[
            "practice",
            "suite",
            "pairs",
            "real",
            "discover",
            "mechanisms",
            "rivals",
            "limits",
            "worlds",
        ],
    )
    parser.add_argument(
        "--fast", action="store_true", help="suite: one case per effect; pairs: four"
    )
    parser.add_argument("--only", default="", help="names of cases, robots or effects")
    parser.add_argument("--share", default="1/1", help="suite: which of how many processes this is")
    options = parser.parse_args()
    RESULTS.mkdir(exist_ok=True)
    jax.config.update("jax_enable_x64", True)
    jax.config.update("jax_compilation_cache_dir", str(RESULTS / "compiled"))
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.1)
    only = set(filter(None, options.only.split(",")))
    if options.part == "suite":
        suite(options.fast, only, options.share)
    elif options.part == "pairs":
        pairs(options.fast)
    elif options.part == "discover":
        from benchmarks.diagnosis_discover import run_discover

        run_discover(options.fast, options.share)
    elif options.part == "mechanisms":
        from benchmarks.diagnosis_mechanisms import run_mechanisms

        run_mechanisms(options.fast, options.share)
    elif options.part == "limits":
        from benchmarks.diagnosis_limits import run_limits

        run_limits(options.fast, only, options.share)
    elif options.part == "rivals":
        from benchmarks.diagnosis_rivals import run_rivals

        run_rivals(options.fast)
    elif options.part == "practice":
        practice(only)
    else:
        real(only)


if __name__ == "__main__":
    main()
