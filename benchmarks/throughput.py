"""How long one update takes, beside the peers, measured in turns within one run.

    python -m benchmarks.throughput [--fast] [--algorithms PSO DE] [--sizes 50x13x1000] [--dtypes float32]

For algorithm, population x dimensions x runs, and precision: one update and one evaluation of the sphere
(the same for all), ours, evosax's, for swarms also ours with random numbers switched off and those of
pyswarms and pagmo, each where it is installed. Compile time is that of the first call. What has been measured
is written after every cell; a cell that fails is told, and the others are measured all the same.
"""

import argparse
import itertools
import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterable

NEEDS = ("evosax", "pyswarms")
TAKES = "10 to 15 minutes; --fast 3 minutes"
ALGORITHMS = ("PSO", "DE", "CMA-ES", "L-SHADE")
SIZES = ((50, 13, 1), (50, 13, 1000), (1000, 30, 100), (10000, 50, 1))
DTYPES = ("float32", "float64")
TARGETS = "at least 1.3 times evosax in every cell; 50x13x1: at least 25 times pyswarms; compile below 1.5 s"
WORK = 4e7
"""Coordinates updated in a timed call, so that calls of all sizes take about as long."""
SECONDS = 1.5
"""About as long one timed call may last: what is slow makes fewer updates."""


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--fast", action="store_true", help="three rounds in place of nine")
    parser.add_argument("--algorithms", nargs="+", choices=ALGORITHMS, default=ALGORITHMS)
    parser.add_argument("--sizes", nargs="+", type=size, default=SIZES)
    parser.add_argument("--dtypes", nargs="+", choices=DTYPES, default=DTYPES)
    parser.add_argument("--cell", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.cell:
        algorithm, sizes = options.cell.split()
        rows = measure(algorithm, *size(sizes), options.fast)
        print("\n".join(json.dumps(row) for row in rows))
        return
    cells = itertools.product(options.algorithms, options.sizes, options.dtypes)
    failed = in_turn(cells, lambda *cell: in_process(*cell, options.fast))
    if failed:
        sys.exit(f"{failed} of the cells failed, see above")


def in_turn(cells: Iterable[tuple], rows_of: Callable[..., list[dict]]) -> int:
    """Measure, print and write cell by cell; the number of those that failed."""
    from benchmarks.timing import write_lines

    rows, failed, path = [], 0, None
    for cell in cells:
        try:
            found = rows_of(*cell)
        except subprocess.CalledProcessError as error:
            failed += 1
            print(*cell, "failed:", error.stderr, flush=True)
            continue
        rows += found
        report(found)
        path = write_lines("throughput.jsonl", rows)
    print("targets:", TARGETS)
    print("written to", path)
    return failed


def size(text: str) -> tuple[int, int, int]:
    """Read ``50x13x1``."""
    n, dims, runs = map(int, text.split("x"))
    return n, dims, runs


def in_process(algorithm: str, sizes: tuple, dtype: str, fast: bool) -> list[dict]:
    """Rows of a cell, from a process of its own: float64 is a switch of the whole of JAX."""
    command = [sys.executable, "-m", "benchmarks.throughput", "--cell"]
    command += [f"{algorithm} {'x'.join(map(str, sizes))}"] + ["--fast"] * fast
    environment = os.environ | {"JAX_ENABLE_X64": str(int(dtype == "float64"))}
    output = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    return [json.loads(line) for line in output.stdout.splitlines() if line.startswith("{")]


def measure(algorithm: str, n: int, dims: int, runs: int, fast: bool) -> list[dict]:
    """Rows of one cell; JAX must already be set to its precision."""
    import jax.numpy as jnp

    from benchmarks.throughput_rivals import ours, peers
    from benchmarks.timing import core_ratio, interleaved, machine, ratio
    from jaxswarm.swarm import random

    # Random numbers switched off: the same program, with one number a stream and step for all lanes.
    random.SOURCES["off"] = _one_for_all
    cell = dict(algorithm=algorithm, num_particles=n, dims=dims, runs=runs)
    cell["dtype"] = str(jnp.result_type(float))
    most = max(3, min(2000, int(WORK / (n * dims * runs))))
    builds = {"jaxswarm": lambda steps: ours(algorithm, n, dims, runs, steps, "hash")}
    if algorithm == "PSO":
        builds["jaxswarm, random off"] = lambda steps: ours(algorithm, n, dims, runs, steps, "off")
    for name in peers(algorithm, n, dims, runs, 3):
        builds[name] = lambda steps, name=name: peers(algorithm, n, dims, runs, steps)[name]
    steps = {name: few_enough(build, most) for name, build in builds.items()}
    timed = interleaved(
        {name: build(steps[name]) for name, build in builds.items()}, 3 if fast else 9
    )
    rows = []
    for name, times in timed.items():
        share = steps["jaxswarm"] / steps[name]
        rows.append(
            cell
            | dict(
                name=name,
                us_per_update=1e6 * times.median / steps[name],
                times_jaxswarm=share * ratio(timed, name, "jaxswarm"),
                core_times_jaxswarm=share * core_ratio(timed, name, "jaxswarm"),
                compile_s=times.first - times.median,
                machine=machine(),
            )
        )
    return rows


def few_enough(build, most: int) -> int:
    """Updates that last about ``SECONDS``, at most ``most``."""
    import time

    import jax

    call = build(3)
    jax.block_until_ready(call())
    begin = time.perf_counter()
    jax.block_until_ready(call())
    return max(3, min(most, int(3 * SECONDS / (time.perf_counter() - begin))))


def _one_for_all(key, tag, shape, num):
    import jax
    import jax.numpy as jnp

    word = jax.random.key_data(key)[0]
    return [jnp.broadcast_to(word ^ jnp.uint32(tag + i), shape) for i in range(num)]


def report(rows: list[dict]) -> None:
    """Print a line a row: time of an update, and how many times ours it is by clock and by core-seconds."""
    for row in rows:
        shape = f"{row['num_particles']}x{row['dims']}x{row['runs']}"
        print(
            f"{row['algorithm']:<8} {shape:>12} {row['dtype']} {row['name']:<22} "
            f"{row['us_per_update']:>11.1f} us {row['times_jaxswarm']:>8.2f} x "
            f"{row['core_times_jaxswarm']:>8.2f} x cores {row['compile_s']:>7.2f} s compile",
            flush=True,
        )


if __name__ == "__main__":
    main()
