"""One command at a time in one place, and never over what it reads."""

import hashlib
import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from jaxswarm.errors import InputError

try:
    import fcntl
except ImportError:  # Windows has other locks; two commands in one folder are not told there
    fcntl = None  # type: ignore[assignment]


@contextmanager
def claim(
    out: Path,
    inputs: Sequence[Path | None],
    names: Sequence[str] = (),
    beside: Sequence[Path] = (),
) -> Iterator[None]:
    """Hold an output place for as long as a command works.

    Args:
        out: Folder or file that will be written.
        inputs: Files the command reads; None and names that are no file are passed over.
        names: Files it writes into the folder ``out``; empty: ``out`` is itself the file.
        beside: Further files it may write.

    Raises:
        InputError: If an output is one of the inputs, by whatever way to it, or another command
            of this machine works in the same place.
    """
    out = Path(out)
    for target in [*([out / name for name in names] or [out]), *beside]:
        for given in inputs:
            if given is not None and _same(target, Path(given)):
                raise InputError(
                    f"--out {out}: would overwrite {given}, which is read; choose another --out"
                )
    with _lock(out):
        yield


def _same(one: Path, other: Path) -> bool:
    """Whether both are one file; a folder that is made first may complete the way to it."""
    try:
        return os.path.realpath(one) == os.path.realpath(other) or one.samefile(other)
    except OSError:
        return False


@contextmanager
def _lock(out: Path) -> Iterator[None]:
    """A lock that ends with its process, kept apart from the results: nothing is left in a folder."""
    handle = _open(out) if fcntl else None
    try:
        if handle is not None:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise InputError(
                    f"--out {out}: another command works there; wait for it or choose another --out"
                ) from None
        yield
    finally:
        if handle is not None:
            os.close(handle)


def _open(out: Path) -> int | None:
    """The file that stands for a place, the same by whatever way it is reached; None: no such file."""
    place = os.fsencode(os.path.realpath(out))
    user = os.getuid() if hasattr(os, "getuid") else 0
    name = f"jaxswarm-{user}-{hashlib.sha256(place).hexdigest()[:24]}.lock"
    try:
        flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)
        return os.open(Path(tempfile.gettempdir()) / name, flags, 0o600)
    except OSError:
        return None
