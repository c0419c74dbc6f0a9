"""Commands killed, interrupted, starved of disk, disturbed: nothing is lost, and the rest is the same bytes."""

import shutil
import signal
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.trust.jobs import JOBS, OUT, content, finish, prepare, start
from benchmarks.trust.oracle import LONGEST
from benchmarks.trust.rows import add_row, read_rows

# Before this time [s] Python itself is still starting, and no program of ours can answer a signal.
_STARTED = 1.5
_CODES = {signal.SIGINT: (130, "interrupted"), signal.SIGTERM: (143, "terminated")}
# Files that an unfinished command may leave in its output: from them it goes on.
_KEPT = ("diagnosis.partial.json",)
# Commands that write one set of results, which is left whole or not at all; what answers signals,
# what is killed in turn, and what takes minutes and is killed one time in ten.
_COMMANDS = ("identify", "diagnose", "diagnose --model")
_ANSWERING = (*_COMMANDS, "fleet")
_SHORT, _LONG = (*_ANSWERING, "minimize_resumable"), "study"


class Reference:
    """Time and bytes of every job that nothing disturbs, each run once."""

    def __init__(self, place: Path):
        self.place = place
        self.known: dict[str, tuple[float, dict[str, str]]] = {}

    def of(self, job: str) -> tuple[float, dict[str, str]]:
        if job not in self.known:
            folder = prepare(self.place / f"reference {job}")
            begun = time.perf_counter()
            code, told = finish(start(job, folder))
            if code:
                raise RuntimeError(f"{job} ended with {code}: {told}")
            self.known[job] = time.perf_counter() - begun, content(folder)
        return self.known[job]


def faults(kills: int) -> None:
    """Kill so many times, and try every other fault on every job; rows that exist are not made again."""
    done = {row["fault"] for row in read_rows("faults")}
    with tempfile.TemporaryDirectory(prefix="trust-") as place:
        reference = Reference(Path(place))
        wanted: dict[str, Callable[[Path], str]] = {}
        for k in range(kills):
            job = _LONG if k % 10 == 9 else _SHORT[k % len(_SHORT)]
            wanted[f"kill {k} of {job}"] = _bound(_ended_early, reference, job, signal.SIGKILL, k)
        for job in JOBS:
            for number in _CODES:
                if job not in _ANSWERING:
                    continue
                name = f"{number.name} of {job}"
                wanted[name] = _bound(_ended_early, reference, job, number, len(wanted))
        for name, try_it in _OTHERS.items():
            for job in _COMMANDS:
                wanted[f"{name}: {job}"] = _bound(try_it, reference, job)
        for name, try_it in wanted.items():
            if name not in done:
                folder = Path(place) / "work"
                shutil.rmtree(folder, ignore_errors=True)
                wrong = try_it(prepare(folder))
                add_row("faults", {"fault": name, "survived": not wrong, "what": wrong[-LONGEST:]})


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
    visible = {name for name in left if not name.startswith(".") and name not in _KEPT}
    if code != 0 and number != signal.SIGKILL:
        expected, word = _CODES[number]
        if code != expected or "Traceback" in told or word not in told:
            return f"at {moment:.1f} s of {seconds:.1f} s: code {code}: {told}"
    if visible and job in _COMMANDS and visible != _names(whole):
        return f"at {moment:.1f} s: a part of the results was left: {sorted(visible)}"
    code, told = finish(start(job, folder))
    return _same(whole, folder, code, told, f"after {number.name} at {moment:.1f} s")


def _names(whole: dict[str, str]) -> set[str]:
    return {name for name in whole if not name.startswith(".")}


def _same(whole: dict[str, str], folder: Path, code: int, told: str, when: str) -> str:
    found = content(folder)
    if code:
        return f"{when}: ended with {code}: {told}"
    other = {name for name in whole.keys() | found.keys() if whole.get(name) != found.get(name)}
    return f"{when}: other bytes: {sorted(other)}" if other else ""


def _full_disk(folder: Path, reference: Reference, job: str) -> str:
    """No file may grow beyond 8 KiB: the set does not fit, and nothing of it may be left."""
    return _refused(folder, *finish(start(job, folder, "ulimit -f 16")), ("cannot write",))


def _no_folder(folder: Path, reference: Reference, job: str) -> str:
    """The output is a place that takes no files, whoever asks."""
    (folder / OUT).symlink_to("/proc/self")
    code, told = finish(start(job, folder))
    if code != 2 or "Traceback" in told or "cannot" not in told:
        return f"code {code}: {told}"
    return ""


def _vanished(folder: Path, reference: Reference, job: str) -> str:
    """The output is taken away in the midst of the work: it is made again."""
    seconds, whole = reference.of(job)
    (folder / OUT).mkdir()
    process = start(job, folder)
    time.sleep(0.6 * seconds)
    shutil.rmtree(folder / OUT, ignore_errors=True)
    return _same(whole, folder, *finish(process), "after its folder vanished")


def _spoiled_cache(folder: Path, reference: Reference, job: str) -> str:
    """Compiled code on disk is damaged: it is compiled again."""
    _, whole = reference.of(job)
    cache = folder / "cache"
    finish(start(job, folder, JAX_COMPILATION_CACHE_DIR=str(cache)))
    shutil.rmtree(folder / OUT)
    rng = np.random.default_rng(0)
    for path in cache.rglob("*"):
        if path.is_file():
            size = path.stat().st_size
            path.write_bytes(
                rng.bytes(size) if rng.random() < 0.5 else path.read_bytes()[: size // 2]
            )
    ended = finish(start(job, folder, JAX_COMPILATION_CACHE_DIR=str(cache)))
    return _same(whole, folder, *ended, "with a damaged cache")


def _two_at_once(folder: Path, reference: Reference, job: str) -> str:
    """Two commands in one place: one works, the other is refused."""
    _, whole = reference.of(job)
    ends = [finish(p) for p in [start(job, folder), start(job, folder)]]
    codes = sorted(code for code, _ in ends)
    told = " ".join(text for _, text in ends)
    if codes != [0, 2] or "another command works there" not in told:
        return f"codes {codes}: {told}"
    return _same(whole, folder, 0, "", "beside another one")


def _refused(folder: Path, code: int, told: str, words: tuple[str, ...]) -> str:
    left = {name for name in content(folder) if name not in _KEPT}
    if code != 2 or "Traceback" in told or not all(word in told for word in words):
        return f"code {code}: {told}"
    return f"left {sorted(left)}" if left else ""


_OTHERS = {
    "disk full": _full_disk,
    "folder that takes no files": _no_folder,
    "folder vanished": _vanished,
    "cache damaged": _spoiled_cache,
    "two in one folder": _two_at_once,
}
