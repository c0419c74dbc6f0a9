"""Commands killed, interrupted, starved of disk, disturbed: nothing is lost, and the rest is the same bytes."""

import shutil
import signal
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.trust.jobs import content, finish, prepare, start
from benchmarks.trust.killed import KILLS, Copies, chain, job_of
from benchmarks.trust.oracle import LONGEST
from benchmarks.trust.reference import KEPT, Reference, names, same
from benchmarks.trust.rows import add_row, read_rows
from benchmarks.trust.surroundings import OTHERS

# Before this time [s] Python itself is still starting, and no program of ours can answer a signal.
_STARTED = 1.5
_CODES = {signal.SIGINT: (130, "interrupted"), signal.SIGTERM: (143, "terminated")}
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
            for number in _CODES:
                name = f"{number.name} of {job}"
                wanted[name] = _bound(_ended_early, reference, job, number, len(wanted))
        for name, try_it in OTHERS.items():
            for job in _COMMANDS:
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


def _ended_early(
    folder: Path, reference: Reference, job: str, number: signal.Signals, k: int
) -> str:
    """End a job at a random moment; what is wrong with what it left, said, and makes of it afterwards."""
    seconds, whole = reference.of(job)
    moment = float(np.random.default_rng([k, 9]).uniform(_STARTED, max(seconds, _STARTED + 0.5)))
    process = start(job, folder)
    time.sleep(moment)
    process.send_signal(number)
    code, told = finish(process)
    left = content(folder)
    visible = {name for name in left if not name.startswith(".") and name not in KEPT}
    if code != 0 and number != signal.SIGKILL:
        expected, word = _CODES[number]
        if code != expected or "Traceback" in told or word not in told:
            return f"at {moment:.1f} s of {seconds:.1f} s: code {code}: {told}"
    if visible and job in _COMMANDS and visible != names(whole):
        return f"at {moment:.1f} s: a part of the results was left: {sorted(visible)}"
    code, told = finish(start(job, folder))
    return same(whole, folder, code, told, f"after {number.name} at {moment:.1f} s")
