"""Where the time of a whole command goes: ``diagnose``, ``identify`` and ``predict`` in fresh processes.

    python -m benchmarks.profiling [--only three,six] [--cold] [--seconds 20] [--rounds 1]

Synthetic logs of three and six joints, with nothing missing and with an effect that is not declared. Every
command runs as a user runs it, in a process of its own that finds compiled code on disk (``--cold``: an
empty cache first). Stages exclude each other; what runs in other threads meanwhile is told apart. Beside
the seconds on the clock stand those that the process computed: other programs hardly change them. Rows go
to ``benchmarks/results/profile.jsonl``.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from benchmarks.profiling_command import STAGES, START

TAKES = "3 minutes; --cold 5"
FRICTION = "viscous_friction,coulomb_friction"
RATE = 250.0
ROBOTS = {"three": "rx60", "six": "ur10e"}
CHILD = "from benchmarks.profiling_command import main; main()"
RESULTS = Path(__file__).parent / "results"


class Command(NamedTuple):
    """One command on logs in a folder: what it is called in the table, and its words."""

    name: str
    words: tuple[str, ...]


def write_logs(robot_name: str, folder: Path, seconds: float) -> None:
    """Write ``complete.npz``, ``lacking.npz`` (with an undeclared effect) and ``other.npz``."""
    import jax

    jax.config.update("jax_enable_x64", True)
    from jaxswarm.effects.term import Term, parse_terms
    from jaxswarm.identify.synthetic import random_links, synthetic_log
    from jaxswarm.robot import load_robot

    robot = load_robot(robot_name)
    robot = robot.replace(parameters=random_links(robot, np.random.default_rng(0)))
    declared = tuple(
        Term(t.effect, t.joint, values={p.name: 4.0 / (1 + t.joint) for p in t.law.parameters})
        for t in parse_terms(FRICTION, robot.joints)
    )
    hidden = Term("stribeck_friction", 1, values={"df": 4.0, "vs": 0.1, "delta": 2.0})
    for name, terms, seed in (
        ("complete", declared, 1),
        ("lacking", (*declared, hidden), 1),
        ("other", declared, 2),
    ):
        log = synthetic_log(robot, terms, seed, duration=seconds, rate=RATE)
        np.savez(folder / f"{name}.npz", t=log.t, q=log.q, tau=log.tau)


def commands(robot: str, folder: Path, out: Path) -> Iterator[Command]:
    """The commands that are measured, in the order in which they run."""
    for name in ("complete", "lacking"):
        log = str(folder / f"{name}.npz")
        words = (log, "--robot", robot, "--declare", FRICTION, "--out", str(out / name))
        yield Command(f"diagnose, {name}", ("diagnose", *words))
    log = str(folder / "complete.npz")
    words = (log, "--robot", robot, "--effects", FRICTION, "--out", str(out / "identified"))
    yield Command("identify", ("identify", *words))
    model = str(out / "identified" / "model.json")
    words = (model, str(folder / "other.npz"), "--out", str(out / "torque.csv"))
    yield Command("predict", ("predict", *words))


def measure(command: Command, cache: Path) -> dict:
    """Run one command in a fresh process and return its row."""
    with tempfile.TemporaryDirectory() as folder:
        told = Path(folder) / "told.json"
        environment = {**os.environ, "JAX_COMPILATION_CACHE_DIR": str(cache)}
        words = [sys.executable, "-c", CHILD, str(told), *command.words]
        # Taken last: all that follows is the command's own time.
        environment[START] = repr(time.time())
        subprocess.run(words, env=environment, check=True, stdout=subprocess.DEVNULL)
        return {"command": command.name, **json.loads(told.read_text())}


def table(rows: list[dict]) -> str:
    """One column a command, one row a stage: seconds on the clock."""
    heads = [f"{row['joints']}, {row['command']}, {row['cache']}" for row in rows]
    lines = ["| seconds of | " + " | ".join(heads) + " |", "|---|" + "---|" * len(rows)]

    def line(name: str, values) -> str:
        return f"| {name} | " + " | ".join(f"{v:.2f}" for v in values) + " |"

    for stage in STAGES:
        lines.append(line(stage, (row["stages"].get(stage, 0.0) for row in rows)))
    lines.append(line("**on the clock**", (row["seconds"] for row in rows)))
    lines.append(line("**computed, all threads**", (row["cpu_seconds"] for row in rows)))
    lines.append(
        line("computed per joint and second of log", (row["cpu_per_joint_second"] for row in rows))
    )
    lines.append(line("peak memory [GiB]", (row["peak_gib"] for row in rows)))
    lines.append(line("programs of JAX", (row["programs"] for row in rows)))
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", default=",".join(ROBOTS), help="three, six")
    parser.add_argument("--cold", action="store_true", help="also with an empty cache")
    parser.add_argument("--seconds", type=float, default=20.0, help="length of the logs")
    parser.add_argument(
        "--rounds", type=int, default=1, help="how often; the least computed counts"
    )
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for size in options.only.split(","):
            rows += profile(size, Path(folder) / size, options)
    RESULTS.mkdir(exist_ok=True)
    lines = "".join(json.dumps(row) + "\n" for row in rows)
    (RESULTS / "profile.jsonl").write_text(lines)
    print(table(rows))


def profile(size: str, folder: Path, options: argparse.Namespace) -> list[dict]:
    """Rows of all commands on the logs of one robot."""
    folder.mkdir()
    robot = ROBOTS[size]
    write_logs(robot, folder, options.seconds)
    cache, rows = folder / "compiled", []
    for kind in ("cold", *["warm"] * options.rounds):
        out = folder / f"out_{len(rows)}"
        for command in commands(robot, folder, out):
            row = measure(command, cache)
            joints = 3 if size == "three" else 6
            per = row["cpu_seconds"] / joints / options.seconds
            rows.append({**row, "cache": kind, "joints": joints, "cpu_per_joint_second": per})
    kept = [row for row in rows if row["cache"] == "warm" or options.cold]
    best: dict[tuple, dict] = {}
    for row in kept:
        key = (row["command"], row["cache"])
        if key not in best or row["cpu_seconds"] < best[key]["cpu_seconds"]:
            best[key] = row
    return list(best.values())


if __name__ == "__main__":
    main()
