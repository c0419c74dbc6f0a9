"""Files of compiled programs: written whole, read only where nobody else can have written them, and bounded."""

import contextlib
import hashlib
import itertools
import os
import pickle
import re
import stat
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from jax.experimental import serialize_executable

# Bytes of programs that are kept, the latest: those of some hundred shapes of logs.
MOST = 512 * 1024**2
# Room is made at the first program that a process writes, and at every so many more: to look through five
# thousand files took 0.14 s, once for each of the hundred programs of a log of a new shape.
_EVERY, _WRITTEN = 32, itertools.count()
# Names of programs, and of those that are being written.
_OURS = re.compile(r"[0-9a-f]{64}(\.[^/]*)?")


def read(path: Path) -> Callable | None:
    """A program as it was written; None where there is none, or it is damaged or another one."""
    try:
        if not is_mine(path):
            return None
        sum_, _, content = path.read_bytes().partition(b"\n")
        if _sum(path, content) != sum_:
            return None
        return serialize_executable.deserialize_and_load(*pickle.loads(content))
    except Exception:  # whatever does not fit here is made anew
        return None


def _sum(path: Path, content: bytes) -> bytes:
    """What tells whether a file holds what was written under its name."""
    return hashlib.sha256(path.name.encode() + b"\n" + content).hexdigest().encode()


def is_mine(path: Path) -> bool:
    """Whether nobody else can have written a file: a program is run as it is read."""
    if not hasattr(os, "getuid"):
        return True  # a system without owners keeps its caches where only their user writes
    return all(_only_mine(one) for one in (path, path.parent))


def _only_mine(path: Path) -> bool:
    """Whether it is ours and no other may write it; a link could lead anywhere."""
    known = path.lstat()
    others = known.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
    return known.st_uid == os.getuid() and not others and not stat.S_ISLNK(known.st_mode)


def make_room(folder: Path) -> None:
    """Remove the oldest programs until the rest take no more than :data:`MOST` bytes.

    Whatever else stands in the folder was put there by somebody else, and stays.
    """
    kept = []
    with os.scandir(folder) as every:  # a third of the time that paths take
        for one in every:
            if _OURS.fullmatch(one.name) and one.is_file(follow_symlinks=False):
                known = one.stat(follow_symlinks=False)
                kept.append((known.st_mtime, known.st_size, one.path))
    left = sum(size for _, size, _ in kept)
    if left <= MOST:
        return
    for _, size, path in sorted(kept):
        with contextlib.suppress(FileNotFoundError):  # another process makes room too
            os.unlink(path)
        left -= size
        if left <= MOST:
            return


def write(path: Path, compiled: Any) -> None:
    """Keep a program, whole or not at all; nothing is said where that fails."""
    beside = None
    try:
        content = pickle.dumps(serialize_executable.serialize(compiled))
        folder = path.parent
        if not folder.exists():
            folder.mkdir(parents=True, exist_ok=True)
            folder.chmod(folder.stat().st_mode & ~(stat.S_IWGRP | stat.S_IWOTH))
        if hasattr(os, "getuid") and not _only_mine(folder):
            return  # it would not be read from there either
        # A name of its own: processes of two containers may have the same number.
        handle, name = tempfile.mkstemp(dir=folder, prefix=f"{path.name}.")
        beside = Path(name)
        with open(handle, "wb") as file:
            file.write(_sum(path, content) + b"\n" + content)
        beside.replace(path)
        if next(_WRITTEN) % _EVERY == 0:
            make_room(folder)
    except Exception:  # a full disk, a folder that takes nothing, a program that JAX cannot write
        if beside is not None:
            with contextlib.suppress(OSError):
                beside.unlink()
