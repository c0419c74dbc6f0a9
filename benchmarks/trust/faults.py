"""Commands killed, interrupted, starved of disk, disturbed: nothing is lost, and the rest is the same bytes."""

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

from benchmarks.trust.jobs import prepare
from benchmarks.trust.killed import ASKED, KILLS, Copies, chain, ended_early, job_of
from benchmarks.trust.oracle import LONGEST
from benchmarks.trust.reference import Reference
from benchmarks.trust.rows import add_row, read_rows
from benchmarks.trust.surroundings import OTHERS

# Commands that write one set of results, which is left whole or not at all, and what answers signals.
_COMMANDS = ("identify", "diagnose", "diagnose --model")
_ANSWERING = (*_COMMANDS, "fleet", "study")


def faults(kills: int) -> None:
    """Kill so many times, and try every other fault on every job; rows that exist are not made again."""
    done = {row["fault"] for row in read_rows("faults")}
    with tempfile.TemporaryDirectory(prefix="trust-") as place:
        reference = Reference(Path(place))
        wanted: dict[str, Callable[[Path], str]] = {}
        copies = Copies(Path(place))
        for k in range(-(-kills // KILLS)):
            job = job_of(k)
            wanted[f"kills {k} of {job}"] = _bound(chain, copies, job, k)
        for job in _ANSWERING:
            for number in ASKED:
                name = f"{number.name} of {job}"
                wanted[name] = _bound(ended_early, copies, job, number, len(wanted))
        for job in _COMMANDS:
            for name, try_it in OTHERS.items():
                wanted[f"{name}: {job}"] = _bound(try_it, reference, job)
        for name, try_it in wanted.items():
            if name not in done:
                folder = Path(place) / "work"
                shutil.rmtree(folder, ignore_errors=True)
                wrong = try_it(prepare(folder))
                tries = KILLS if name.startswith("kills ") else 1
                row = {"fault": name, "tries": tries, "survived": not wrong}
                add_row("faults", {**row, "what": wrong[-LONGEST:]})


def _bound(try_it: Callable, *arguments) -> Callable[[Path], str]:
    return lambda folder: try_it(folder, *arguments)
