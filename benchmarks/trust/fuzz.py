"""Spoiled inputs in process: input k is the same at any time, and a failing one is kept with its files."""

import shutil
import tempfile
from collections import Counter
from pathlib import Path

from benchmarks.trust import targets
from benchmarks.trust.oracle import Outcome, watched
from benchmarks.trust.rows import FINDINGS, add_row, read_rows

# Inputs of one row: an interruption loses at most so many.
_CHUNK = 200


def fuzz(inputs: int) -> None:
    """Try inputs up to a number; those of earlier runs are not tried again."""
    done = {row["first"] for row in read_rows("fuzz") if row["kind"] == "inputs"}
    with tempfile.TemporaryDirectory(prefix="trust-") as place:
        for first in range(0, inputs, _CHUNK):
            if first not in done:
                add_row("fuzz", _chunk(first, min(first + _CHUNK, inputs), Path(place) / "input"))


def _chunk(first: int, end: int, folder: Path) -> dict:
    counts: Counter[str] = Counter()
    findings, slowest = [], 0.0
    for number in range(first, end):
        name, outcome = one(number, folder)
        counts[f"{name} {outcome.kind}"] += 1
        slowest = max(slowest, outcome.seconds)
        if outcome.wrong:
            findings.append(
                {"input": number, "of": name, "kind": outcome.kind, "what": outcome.what}
            )
            shutil.copytree(folder, FINDINGS / str(number), dirs_exist_ok=True)
    return {
        "kind": "inputs",
        "first": first,
        "count": end - first,
        "counts": dict(counts),
        "slowest": slowest,
        "findings": findings,
    }


def one(number: int, folder: Path, of: str = "") -> tuple[str, Outcome]:
    """Make one input, read it, and see that reading wrote nothing where it was refused."""
    name, call = targets.make(number, folder, of)
    before = _content(folder)
    outcome = watched(call)
    if outcome.kind == "refused" and _content(folder) != before:
        outcome = Outcome("wrote", "files changed though the input was refused", outcome.seconds)
    return name, outcome


def _content(folder: Path) -> dict[str, int]:
    return {str(p): p.stat().st_mtime_ns for p in sorted(folder.rglob("*")) if p.is_file()}
