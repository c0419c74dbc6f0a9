"""Whole commands with odd options and spoiled files, each in a process of its own.

Most are copies of one process that has loaded everything, which takes a tenth of the time; every tenth one is
started anew.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from benchmarks.trust.command_words import words_of
from benchmarks.trust.forked import run_copy
from benchmarks.trust.oracle import LONGEST
from benchmarks.trust.rows import FINDINGS, add_row, read_rows

# Time [s] a command may take, work included; address space [KiB] it may have.
SLOWEST, _SPACE = 300.0, 24 * 2**20


def run_commands(count: int) -> None:
    """Run commands up to a number; those of earlier runs are not run again."""
    done = {row["command"] for row in read_rows("fuzz") if row["kind"] == "command"}
    for k in range(count):
        if k not in done:
            add_row("fuzz", one_command(k))


def one_command(k: int) -> dict:
    """Make and run the command of a number, and say what was wrong with how it ended."""
    with tempfile.TemporaryDirectory(prefix="trust-") as place:
        folder = Path(place)
        rng = np.random.default_rng([k, 500])
        words = words_of(rng, folder)
        before = {p for p in folder.rglob("*")}
        start = time.perf_counter()
        code, text, told = _run(words, folder, anew=k % 10 == 0)
        seconds = time.perf_counter() - start
        new = sorted(str(p.relative_to(folder)) for p in {*folder.rglob("*")} - before)
        finding = _wrong(code, text, told, new, seconds)
        if finding:
            shutil.copytree(folder, FINDINGS / f"command{k}", dirs_exist_ok=True)
    shown = [w.replace(place, ".") for w in words]
    row = {"kind": "command", "command": k, "name": words[0], "code": code, "seconds": seconds}
    return {**row, "finding": finding, "words": [w[:100] for w in shown]}


def _run(words: list[str], place: Path, anew: bool) -> tuple[int, str, str]:
    if not anew:
        code, *texts = run_copy(words, place, SLOWEST, 1024 * _SPACE)
        return code, *(x.decode("utf-8", "replace") for x in texts)
    shell = f'ulimit -v {_SPACE} && exec "$0" -m jaxswarm "$@"'
    try:
        ended = subprocess.run(
            ["sh", "-c", shell, sys.executable, *words],
            capture_output=True,
            timeout=SLOWEST,
            check=False,
            cwd=place,
            env={**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[2])},
        )
    except subprocess.TimeoutExpired:
        return -1, "", "out of time"
    return ended.returncode, *(x.decode("utf-8", "replace") for x in (ended.stdout, ended.stderr))


def _wrong(code: int, text: str, told: str, new: list[str], seconds: float) -> str:
    if code not in (0, 2):
        return f"ended with {code}: {told[-LONGEST:]}"
    if "Traceback" in told:
        return f"traceback: {told[-LONGEST:]}"
    if any(not c.isprintable() and c != "\n" for c in told):
        return f"control characters: {told[:LONGEST]!r}"
    if code == 2 and (new or text):
        return f"refused, but wrote {new or text[:200]}"
    if code == 2 and not told.strip():
        return "refused without a word"
    return ""
