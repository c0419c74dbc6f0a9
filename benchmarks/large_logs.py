"""Seconds and memory of ``identify`` and ``diagnose`` against the length of a log.

    python -m benchmarks.large_logs [--joints 3] [--samples 10000,100000,1000000] [--rate 1000]
                                    [--command identify|diagnose]

Each length runs as a process of its own; its peak memory and the seconds it computed are told, beside the
exponents of both in the number of samples (a straight line in their logarithms, from 100,000 samples on,
where the start of the process no longer counts). Rows go to ``benchmarks/results/large_logs.jsonl``.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import jax
import numpy as np

from benchmarks.timing import write_lines
from jaxswarm.identify.forward.columns import torque_of
from jaxswarm.identify.synthetic import random_links
from jaxswarm.robot import load_robot

TAKES = (
    "3 minutes; identify of seven joints and ten million samples 3 minutes of a core and 3.3 GiB"
)
FRICTION = "viscous_friction,coulomb_friction"
ROBOTS = {1: "emps", 3: "rx60", 6: "ur10e", 7: "seven.toml"}
SEVEN = """
[dh]
convention = "modified"
alpha = [0, -1.5708, 1.5708, 1.5708, -1.5708, 1.5708, 1.5708]
a = [0, 0, 0, 0.08, -0.08, 0, 0.09]
d = [0.33, 0, 0.32, 0, 0.38, 0, 0.1]
"""
# Samples that are made at a time.
_BLOCK = 50_000
# From here on the length of the log decides, not the start of the process.
LONG = 100_000
# Run by a process that does nothing else: the peak of a child is told only of all children together.
RUN = """
import json, resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL)
told = resource.getrusage(resource.RUSAGE_CHILDREN)
print(json.dumps([told.ru_utime + told.ru_stime, told.ru_maxrss / 1024**2]))
"""


def write_log(path: Path, robot_name: str, samples: int, rate: float) -> None:
    """A motion of eight incommensurate waves a joint, with rigid body, friction and noise."""
    robot = load_robot(robot_name)
    rng = np.random.default_rng(0)
    pi = random_links(robot, rng).ravel()
    frequencies = 0.07 * 1.37 ** np.arange(8)[:, None]
    w, n = 2 * np.pi * frequencies, robot.num_joints
    size = rng.uniform(0.05, 0.15, (8, n)) / frequencies**0.5
    start = rng.uniform(0, 2 * np.pi, (8, n))
    t, (q, tau) = np.arange(samples) / rate, np.empty((2, samples, n))
    for first in range(0, samples, _BLOCK):
        part = slice(first, first + _BLOCK)
        angle = w * t[part, None, None] + start
        at = (size * np.sin(angle)).sum(axis=1)
        dq = (size * w * np.cos(angle)).sum(axis=1)
        ddq = -(size * w**2 * np.sin(angle)).sum(axis=1)
        tau[part] = torque_of(robot, at, dq, ddq, pi) + 5.0 * dq + 4.0 * np.tanh(dq / 0.01)
        tau[part] += 0.2 * rng.normal(size=at.shape)
        q[part] = at + 2e-5 * rng.normal(size=at.shape)
    np.savez(path, t=t, q=q, tau=tau)


def measure(command: str, robot: str, samples: int, rate: float) -> dict:
    """One row: seconds on the clock and computed, and peak memory, of a command on a log."""
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log.npz"
        if robot.endswith(".toml"):
            robot = str(Path(folder) / robot)
            Path(robot).write_text(SEVEN, encoding="utf-8")
        write_log(log, robot, samples, rate)
        effects = "--effects" if command == "identify" else "--declare"
        words = [sys.executable, "-m", "jaxswarm", command, str(log), "--robot", robot]
        words += [effects, FRICTION, "--out", f"{folder}/out"]
        start = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-c", RUN, *words], check=True, capture_output=True, text=True
        )
        used, peak = json.loads(done.stdout)
        row = {"command": command, "robot": Path(robot).stem, "samples": samples, "rate": rate}
        seconds = time.perf_counter() - start
        return {**row, "seconds": seconds, "cpu_seconds": used, "peak_gib": peak}


def exponents(rows: list[dict]) -> dict[str, float]:
    """Slopes of the logarithms of seconds and memory over that of the samples, of the long logs.

    >>> rows = [{"samples": n, "cpu_seconds": n / 1e5, "peak_gib": 2.0} for n in (1e5, 1e6)]
    >>> {name: round(value, 3) for name, value in exponents(rows).items()}
    {'cpu_seconds': 1.0, 'peak_gib': 0.0}
    """
    long = [row for row in rows if row["samples"] >= LONG]
    if len(long) < 2:
        return {}
    x = np.log([row["samples"] for row in long])
    names = ("cpu_seconds", "peak_gib")
    return {n: float(np.polyfit(x, np.log([row[n] for row in long]), 1)[0]) for n in names}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--joints", type=int, choices=sorted(ROBOTS), default=3)
    parser.add_argument("--samples", default="10000,100000,1000000", help="lengths, with commas")
    parser.add_argument("--rate", type=float, default=1000.0, help="samples a second")
    parser.add_argument("--command", choices=("identify", "diagnose"), default="identify")
    options = parser.parse_args()
    jax.config.update("jax_enable_x64", True)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    rows = []
    for samples in map(int, options.samples.split(",")):
        rows.append(measure(options.command, ROBOTS[options.joints], samples, options.rate))
        print(json.dumps(rows[-1]), flush=True)
    print("exponents:", json.dumps(exponents(rows)))
    write_lines("large_logs.jsonl", rows)


if __name__ == "__main__":
    main()
