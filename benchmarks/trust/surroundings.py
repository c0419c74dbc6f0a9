"""What may be wrong around a command: its disk, its folders, its caches, its clock, another command."""

import json
import os
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from benchmarks.trust.jobs import OUT, ROOT, finish, prepare, start
from benchmarks.trust.reference import KEPT, Reference, refused, same
from jaxswarm.manifest import MANIFEST
from jaxswarm.programs import FOLDER

# A time [s] that no clock shows yet, and a module that sets the clock back a day after every reading.
_FUTURE = 4e9
_FALLING = """
import itertools, time
begun, falls = time.time(), itertools.count()
time.time = lambda: begun - 86400.0 * next(falls)
"""


def _full_disk(folder: Path, reference: Reference, job: str) -> str:
    """No file may grow beyond 8 KiB: the set does not fit, and nothing of it may be left."""
    return refused(folder, *finish(start(job, folder, "ulimit -f 16")), ("cannot write",))


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
    return same(whole, folder, *finish(process), "after its folder vanished")


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
    return same(whole, folder, *ended, "with a damaged cache")


def _two_at_once(folder: Path, reference: Reference, job: str) -> str:
    """Two commands in one place: one works, the other is refused."""
    _, whole = reference.of(job)
    ends = [finish(p) for p in [start(job, folder), start(job, folder)]]
    codes = sorted(code for code, _ in ends)
    told = " ".join(text for _, text in ends)
    if codes != [0, 2] or "another command works there" not in told:
        return f"codes {codes}: {told}"
    return same(whole, folder, 0, "", "beside another one")


def _small_disk(folder: Path, reference: Reference, job: str) -> str:
    """A disk of 64 KiB, as in reality: pages are taken as they are written."""
    (folder / OUT).mkdir()
    with _mounted(folder / OUT, "-t", "tmpfs", "-o", "size=64k", "tmpfs"):
        return refused(folder, *finish(start(job, folder)), ("cannot write",))


def _read_only(folder: Path, reference: Reference, job: str) -> str:
    """A disk that takes no writing, whoever asks."""
    (folder / OUT).mkdir()
    with _mounted(folder / OUT, "-t", "tmpfs", "-o", "ro", "tmpfs"):
        return refused(folder, *finish(start(job, folder)), ("cannot write", "Read-only"))


@contextmanager
def _mounted(place: Path, *what: str) -> Iterator[None]:
    """Something mounted there; only the administrator may."""
    subprocess.run(["mount", *what, str(place)], check=True)
    try:
        yield
    finally:
        subprocess.run(["umount", str(place)], check=True)


def _no_cache(folder: Path, reference: Reference, job: str) -> str:
    """Compiled code cannot be kept: where its folder should be, there is a file."""
    _, whole = reference.of(job)
    (folder / "cache").write_text("no folder")
    ended = finish(start(job, folder, JAX_COMPILATION_CACHE_DIR=str(folder / "cache")))
    return same(whole, folder, *ended, "without a cache")


def _exchanged(folder: Path, reference: Reference, job: str) -> str:
    """Kept programs stand under each other's names: none is taken for another."""
    _, whole = reference.of(job)
    cache = {"JAX_COMPILATION_CACHE_DIR": str(folder / "cache")}
    for other in {job, "diagnose"}:  # of programs of one kind there is nothing to exchange
        finish(start(other, folder, **cache))
        shutil.rmtree(folder / OUT)
    kept = sorted((folder / "cache" / FOLDER).iterdir())
    contents = [path.read_bytes() for path in kept]
    for path, content in zip(kept, contents[1:] + contents[:1], strict=True):
        path.write_bytes(content)
    return same(whole, folder, *finish(start(job, folder, **cache)), "with exchanged programs")


def _full_cache(folder: Path, reference: Reference, job: str) -> str:
    """The disk of the cache is full, and nobody is troubled by it."""
    _, whole = reference.of(job)
    (folder / "cache").mkdir()
    with _mounted(folder / "cache", "-t", "tmpfs", "-o", "size=64k", "tmpfs"):
        ended = finish(start(job, folder, JAX_COMPILATION_CACHE_DIR=str(folder / "cache")))
    return same(whole, folder, *ended, "with a full cache")


def _linked_cache(folder: Path, reference: Reference, job: str) -> str:
    """Where programs are kept there is a link to somebody's folder: nothing is changed in it."""
    _, whole = reference.of(job)
    (folder / "cache").mkdir()
    (folder / "precious").mkdir()
    (folder / "precious" / "thesis").write_text("years of work")
    (folder / "cache" / FOLDER).symlink_to(folder / "precious")
    ended = finish(start(job, folder, JAX_COMPILATION_CACHE_DIR=str(folder / "cache")))
    left = sorted(path.name for path in (folder / "precious").iterdir())
    return f"left {left}" if left != ["thesis"] else same(whole, folder, *ended, "beside a link")


def _one_cache(folder: Path, reference: Reference, job: str) -> str:
    """Two commands fill one empty cache at the same time, and a third one finds it."""
    _, whole = reference.of(job)
    cache = {"JAX_COMPILATION_CACHE_DIR": str(folder / "cache")}
    places = [prepare(folder / name) for name in ("one", "two")]
    begun = [start(job, place, **cache) for place in places]
    ends = [finish(one) for one in begun]
    places.append(prepare(folder / "three"))
    ends.append(finish(start(job, places[-1], **cache)))
    told = (same(whole, place, *end, place.name) for place, end in zip(places, ends, strict=True))
    return "; ".join(filter(None, told))


def _other_version(folder: Path, reference: Reference, job: str) -> str:
    """What another version left to go on from, its list of results, and its compiled code."""
    _, whole = reference.of(job)
    left = {"fingerprint": "of another version", "rounds": {"0": {"friction/0": [{"v": 1e300}]}}}
    (folder / OUT).mkdir()
    if job.startswith("diagnose"):  # no other command reads it, or may take it away
        (folder / OUT / KEPT[0]).write_text(json.dumps(left))
    (folder / OUT / MANIFEST).write_text(json.dumps({"version": 99, "sets": {"of": [1, None]}}))
    (folder / "cache").mkdir()
    for k in range(9):
        (folder / "cache" / f"jit_add-{k:064x}-cache").write_bytes(b"of another version" * k)
    ended = finish(start(job, folder, JAX_COMPILATION_CACHE_DIR=str(folder / "cache")))
    return same(whole, folder, *ended, "beside what another version left")


def _clock_back(folder: Path, reference: Reference, job: str) -> str:
    """The clock is set back while a command works, and its inputs and earlier results are of the future."""
    _, whole = reference.of(job)
    code, told = finish(start(job, folder))
    if code:
        return f"code {code}: {told}"
    for path in folder.rglob("*"):
        os.utime(path, (_FUTURE, _FUTURE))
    (folder / "clock").mkdir()
    (folder / "clock" / "sitecustomize.py").write_text(_FALLING)
    ended = finish(start(job, folder, PYTHONPATH=f"{ROOT}{os.pathsep}{folder / 'clock'}"))
    return same(whole, folder, *ended, "with a clock that is set back")


OTHERS: dict[str, Callable[[Path, Reference, str], str]] = {
    "disk full": _full_disk,
    "small disk": _small_disk,
    "read-only disk": _read_only,
    "folder that takes no files": _no_folder,
    "folder vanished": _vanished,
    "cache damaged": _spoiled_cache,
    "no place for the cache": _no_cache,
    "programs exchanged": _exchanged,
    "cache full": _full_cache,
    "a link for the programs": _linked_cache,
    "two fill one cache": _one_cache,
    "left by another version": _other_version,
    "clock set back": _clock_back,
    "two in one folder": _two_at_once,
}
