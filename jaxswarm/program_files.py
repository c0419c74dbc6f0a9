"""Files of compiled programs: written whole, read only where nobody else can have written them, and bounded."""

import contextlib
import hashlib
import os
import pickle
import stat
from collections.abc import Callable
from pathlib import Path
from typing import Any

from jax.experimental import serialize_executable

# Bytes of programs that are kept, the latest: those of some hundred shapes of logs.
MOST = 512 * 1024**2


def read(path: Path) -> Callable | None:
    """A program as it was written; None where there is none, or it is damaged."""
    try:
        if not is_mine(path):
            return None
        sum_, _, content = path.read_bytes().partition(b"\n")
        if hashlib.sha256(content).hexdigest().encode() != sum_:
            return None
        return serialize_executable.deserialize_and_load(*pickle.loads(content))
    except Exception:  # whatever does not fit here is made anew
        return None


def is_mine(path: Path) -> bool:
    """Whether nobody else can have written a file: a program is run as it is read."""
    if not hasattr(os, "getuid"):
        return True  # a system without owners keeps its caches where only their user writes
    return all(
        one.stat().st_uid == os.getuid() and not one.stat().st_mode & (stat.S_IWGRP | stat.S_IWOTH)
        for one in (path, path.parent)
    )


def make_room(folder: Path) -> None:
    """Remove the oldest programs until the rest take no more than :data:`MOST` bytes."""
    kept = [(p.stat().st_mtime, p.stat().st_size, p) for p in folder.iterdir()]
    left = sum(size for _, size, _ in kept)
    for _, size, path in sorted(kept):
        if left <= MOST:
            return
        path.unlink(missing_ok=True)
        left -= size


def write(path: Path, compiled: Any) -> None:
    """Keep a program, whole or not at all; nothing is said where that fails."""
    beside = path.with_name(f"{path.name}.{os.getpid()}")
    try:
        content = pickle.dumps(serialize_executable.serialize(compiled))
        path.parent.mkdir(parents=True, exist_ok=True)
        beside.write_bytes(hashlib.sha256(content).hexdigest().encode() + b"\n" + content)
        for one in (beside, path.parent):
            one.chmod(one.stat().st_mode & ~(stat.S_IWGRP | stat.S_IWOTH))
        beside.replace(path)
        make_room(path.parent)
    except Exception:  # a full disk, a folder that takes nothing, a program that JAX cannot write
        with contextlib.suppress(OSError):
            beside.unlink()
