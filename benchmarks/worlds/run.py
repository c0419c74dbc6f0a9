"""Many worlds, resumable and shared among processes: JSON lines under ``benchmarks/results``."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.timing import RESULTS
from benchmarks.worlds.world import World, make_world

# 1300 worlds hold 500 clean ones and 800 others.
COUNT = 1300
FAST = 26


def read_rows(stem: str) -> list[dict]:
    """Rows of all processes that ever worked at this; a line cut short by an interruption is left out."""
    rows = {}
    for path in sorted(RESULTS.glob(f"{stem}-*of*.jsonl")):
        for line in path.read_text().splitlines():
            try:
                row = json.loads(line)
            except json.JSONDecodeError:
                continue
            rows[row["world"]] = row
    return [rows[k] for k in sorted(rows)]


def run_share(
    stem: str,
    chosen: list[int],
    share: str,
    wanted: set[str],
    score: Callable[[World], dict],
    held: bool = False,
) -> None:
    """Score this share of the worlds that are not done yet, in an order drawn once for all.

    ``held``: worlds whose dry friction holds joints at rest.
    """
    own, count = map(int, share.split("/"))
    path = RESULTS / f"{stem}-{own}of{count}.jsonl"
    done = {row["world"] for row in read_rows(stem)}
    for number in np.random.default_rng(0).permutation(chosen)[own - 1 :: count]:
        if int(number) in done:
            continue
        world = make_world(int(number), held=held)
        if wanted and not wanted & topics(world):
            continue
        row = score(world)
        with path.open("a") as file:
            file.write(json.dumps(row) + "\n")
        print(json.dumps(short(row)), flush=True)


def topics(world: World) -> set[str]:
    """The words ``--only`` may name."""
    return {
        *(world.plan.kinds or ("clean",)),
        world.arm.name,
        world.control.kind,
        world.motions["train"].family,
        f"{world.arm.size} joints",
    }


def short(row: dict) -> dict:
    """What is worth a line on the screen."""
    keys = ("name", "added", "verdict", "harm", "error", "seconds")
    truth = [e["label"] for part in ("effects", "outside") for e in row[part]]
    return {"truth": truth, **{k: row[k] for k in keys if k in row}}


def spread(arguments: list[str], share: str, processes: int) -> None:
    """Split a share among processes and wait for them."""
    own, count = map(int, share.split("/"))
    workers = [
        subprocess.Popen(
            [sys.executable, "-m", "benchmarks.diagnosis", "worlds", *arguments]
            + ["--share", f"{own + k * count}/{count * processes}", "--no-table"],
            cwd=Path(__file__).resolve().parents[2],
        )
        for k in range(processes)
    ]
    codes = [worker.wait() for worker in workers]
    if any(codes):
        raise SystemExit(f"processes ended with codes {codes}; start again to go on")
