"""One command at a time in one place, and never over what it reads."""

import contextlib
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
    place = _place_of(out)
    handle = _held(out, place) if fcntl else None
    try:
        yield
    finally:
        if handle is not None:
            with contextlib.suppress(OSError):
                os.unlink(place)  # still held: who opens it now finds out that it is gone
            os.close(handle)


def _held(out: Path, place: Path) -> int | None:
    """The open file of the lock, ours now; None where no such file can be.

    Raises:
        InputError: If it is another command's.
    """
    flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0)
    while True:
        try:
            handle = os.open(place, flags, 0o600)
        except OSError:
            return None
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if _is_at(handle, place):
                return handle
        except BlockingIOError:
            os.close(handle)
            raise InputError(
                f"--out {out}: another command works there; wait for it or choose another --out"
            ) from None
        except OSError:  # a file system without locks
            os.close(handle)
            return None
        os.close(handle)  # whoever held it has just removed it


def _is_at(handle: int, place: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(handle), os.stat(place))
    except OSError:
        return False


def _place_of(out: Path) -> Path:
    """The file that stands for a place, the same by whatever way it is reached."""
    place = os.fsencode(os.path.realpath(out))
    user = os.getuid() if hasattr(os, "getuid") else 0
    name = f"jaxswarm-{user}-{hashlib.sha256(place).hexdigest()[:24]}.lock"
    return Path(tempfile.gettempdir()) / name
