"""Timing that compares: warm up, block on the result, take turns, keep compile time apart.

A machine is never quiet, so candidates are measured in turns, round after round, and the ratio of two
candidates is the median of the ratios within a round. Beside the time on the clock stands the time
that the process computed, summed over its cores: other programs hardly change that one.
"""

import importlib.metadata
import json
import platform
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jax
import numpy as np

RESULTS = Path(__file__).parent / "results"


@dataclass(frozen=True)
class Timed:
    """Times of one candidate: seconds of the first call (with compilation) and of each round.

    ``computed`` holds the core-seconds of each round.
    """

    first: float
    rounds: np.ndarray
    computed: np.ndarray

    @property
    def median(self) -> float:
        return float(np.median(self.rounds))


def interleaved(candidates: dict[str, Callable[[], Any]], rounds: int = 7) -> dict[str, Timed]:
    """Call every candidate once to compile, then in turns; each returns arrays to wait for."""
    first = {name: _seconds(call)[0] for name, call in candidates.items()}
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in candidates}
    for turn in range(rounds):
        names = list(candidates)
        for name in names[turn % len(names) :] + names[: turn % len(names)]:
            times[name].append(_seconds(candidates[name]))
    return {name: Timed(first[name], *np.array(times[name]).T) for name in candidates}


def ratio(timed: dict[str, Timed], name: str, reference: str) -> float:
    """How many times as long ``name`` takes as ``reference``: median over rounds."""
    return float(np.median(timed[name].rounds / timed[reference].rounds))


def core_ratio(timed: dict[str, Timed], name: str, reference: str) -> float:
    """How many times the core-seconds of ``reference`` ``name`` takes: median over rounds."""
    return float(np.median(timed[name].computed / timed[reference].computed))


def machine() -> dict[str, Any]:
    """What the numbers were measured on."""
    versions = {}
    for package in ("jax", "numpy", "evosax", "pyswarms", "pymoo", "mealpy", "scipy"):
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            versions[package] = None
    device = jax.devices()[0]
    return dict(device=device.device_kind, processor=platform.machine(), versions=versions)


def write_lines(name: str, rows: list[dict[str, Any]]) -> Path:
    """Write rows as JSON lines into the results folder."""
    RESULTS.mkdir(exist_ok=True)
    path = RESULTS / name
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    return path


def _seconds(call) -> tuple[float, float]:
    start, computed = time.perf_counter(), time.process_time()
    jax.block_until_ready(call())
    return time.perf_counter() - start, time.process_time() - computed
