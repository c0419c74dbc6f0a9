"""Logs per minute and core of ``diagnose --fleet``, 1 and 2 workers, memory over time, a million arms a day.

    python -m benchmarks.fleet [--arms 8] [--each 2] [--seconds 12] [--workers 1,2] [--price 0.04]

Makes logs of RX60 arms that differ a little, of lengths that differ too; every fifth arm has a cogging motor
that is not declared. Each number of workers begins in an empty folder, in processes of its own, with the
compile cache as it is. Rates leave out the start: they are those between the first and the last result.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from datetime import date, timedelta
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: see jaxswarm.runtime

NEEDS = ("distributed", "fsspec", "pyarrow")
TAKES = "5 minutes on two cores for 16 logs"
RATE = 125.0
DECLARED = "viscous_friction,coulomb_friction"
DAY, MILLION = 86400.0, 1_000_000


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--arms", type=int, default=8)
    parser.add_argument("--each", type=int, default=2, help="logs of every arm")
    parser.add_argument("--seconds", type=float, default=12.0, help="length of a log")
    parser.add_argument("--workers", default="1,2", help="numbers of workers, with commas")
    parser.add_argument("--price", type=float, default=0.04, help="assumed price of a core hour")
    options = parser.parse_args()
    from benchmarks.timing import write_lines

    with tempfile.TemporaryDirectory(prefix="jaxswarm-fleet-") as folder:
        logs = Path(folder) / "logs"
        make_fleet(logs, options.arms, options.each, options.seconds)
        rows = [
            measure(logs, Path(folder) / f"out{count}", int(count))
            for count in options.workers.split(",")
        ]
    for row in rows:
        print(
            ", ".join(
                f"{k} {v:.4g}" if isinstance(v, float) else f"{k} {v}" for k, v in row.items()
            )
        )
    if len(rows) > 1:
        one, other = rows[0], rows[-1]
        gain = other["logs_per_minute"] / one["logs_per_minute"]
        share = gain * one["workers"] / other["workers"]
        print(
            f"{one['workers']} to {other['workers']} workers: {gain:.2f} times, efficiency {share:.0%}"
        )
    print("\n".join(arithmetic(rows[-1], options.price)))
    print("written to", write_lines("fleet.jsonl", rows))


def make_fleet(folder: Path, arms: int, each: int, seconds: float) -> None:
    """Write logs of arms of one kind as ``arm03/2026-01-08.csv``."""
    import jax
    import numpy as np

    jax.config.update("jax_enable_x64", True)
    from jaxswarm.effects.term import Term
    from jaxswarm.identify.synthetic import random_links, synthetic_log
    from jaxswarm.logs import write_log
    from jaxswarm.robot import rx60

    rng = np.random.default_rng(0)
    links = random_links(rx60(), rng)
    for arm in range(arms):
        robot = rx60().replace(parameters=links * (1.0 + 0.01 * rng.normal()))
        terms = [
            Term(name, j, values={symbol: size * rng.uniform(0.9, 1.1) / (1 + j)})
            for name, symbol, size in (
                ("viscous_friction", "b", 5.0),
                ("coulomb_friction", "fc", 4.0),
            )
            for j in range(3)
        ]
        if arm % 5 == 4:
            terms.append(Term("torque_ripple", 0, values={"sine": 0.9, "cosine": 0.7, "n": 22.0}))
        for k in range(each):
            length = seconds * rng.uniform(0.9, 1.1)
            log = synthetic_log(robot, tuple(terms), 100 * arm + k, duration=length, rate=RATE)
            place = folder / f"arm{arm:03d}"
            place.mkdir(parents=True, exist_ok=True)
            day = date(2026, 1, 1) + timedelta(days=7 * k)
            write_log(replace(log, channels={}), place / f"{day}.csv")


def measure(logs: Path, out: Path, workers: int) -> dict:
    """Run the command in an empty folder: rates, processor time, memory over time, bytes."""
    command = [
        sys.executable,
        "-m",
        "jaxswarm",
        "diagnose",
        "--fleet",
        str(logs),
        "--robot",
        "rx60",
    ]
    command += ["--declare", DECLARED, "--out", str(out), "--workers", str(workers), "--json"]
    command += ["--against", "fleet"]
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.time()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    memory = []
    while process.poll() is None:
        memory.append((time.time(), resident(process.pid)))
        time.sleep(1.0)
    result = json.loads(process.stdout.read())
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = sorted(path.stat().st_mtime for path in out.glob("logs/*/*.json"))
    steady = (len(done) - 1) / max(done[-1] - done[0], 1e-9)
    middle = 0.5 * (done[0] + done[-1])
    half, end = (
        max((size for at, size in memory if low <= at <= high), default=0)
        for low, high in ((begin, middle), (middle, done[-1]))
    )
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {
        "workers": workers,
        "logs": len(done),
        "seconds": time.time() - begin,
        "first_result_after": done[0] - begin,
        "logs_per_minute": 60.0 * steady,
        "cpu_seconds_per_log": used / len(done),
        "logs_per_minute_of_a_core": 60.0 * len(done) / used,
        "most_mb_first_half": half / 2**20,
        "most_mb_second_half": end / 2**20,
        "log_kb": mean_size(logs.glob("*/*.csv")),
        "result_kb": mean_size(out.glob("logs/*/*.json")),
        "table_kb_per_log": (out / "fleet.parquet").stat().st_size / 1024 / len(done),
        "load": os.getloadavg()[0],
        "verdicts": json.dumps(result["verdicts"]),
    }


def resident(pid: int) -> int:
    """Bytes in memory of a process and all below it."""
    import psutil

    total = 0
    try:
        top = psutil.Process(pid)
        for process in (top, *top.children(recursive=True)):
            total += process.memory_info().rss
    except psutil.Error:
        pass  # one of them has just ended
    return total


def mean_size(paths) -> float:
    """Mean size of files [KiB]."""
    sizes = [path.stat().st_size for path in paths]
    return sum(sizes) / len(sizes) / 1024


def arithmetic(row: dict, price: float) -> list[str]:
    """What a million logs a day take, from one measured row; what is assumed is said."""
    cores = row["cpu_seconds_per_log"] * MILLION / DAY
    memory = row["most_mb_second_half"] / row["workers"] / 1024
    kept = (row["result_kb"] + row["table_kb_per_log"]) * MILLION / 2**20
    return [
        "a million arms a day, one log each of the length measured here:",
        f"  cores: {row['cpu_seconds_per_log']:.1f} s of a core a log: {cores:.0f} cores kept busy",
        f"  memory: {memory:.1f} GB a worker, one worker a core: {cores * memory:.0f} GB",
        f"  cost: {cores * 24:.0f} core hours a day, {cores * 24 * price:.0f} a day at {price} (assumed)",
        f"  read: {row['log_kb'] * MILLION / 2**20:.0f} GB of logs a day",
        f"  written: {kept:.0f} GB a day, of which the table "
        f"{row['table_kb_per_log'] * MILLION / 2**20:.1f} GB",
        f"  scheduler: {MILLION / DAY:.0f} tasks a second; Dask's own page says one takes about 1 ms",
        "  breaks first: the one process that writes all results and reads them again, twice, for the "
        "table, and a folder with a million entries: part the fleet by kind, site or day",
    ]


if __name__ == "__main__":
    main()
