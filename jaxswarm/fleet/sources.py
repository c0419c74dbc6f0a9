"""The logs of a fleet: a folder, a glob, or either at an address that fsspec knows (s3://, gs://, memory://)."""

import hashlib
import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path, PurePosixPath
from typing import Any, NamedTuple

from jaxswarm.errors import InputError
from jaxswarm.fleet.naming import arm_and_date
from jaxswarm.logs import LOG_FORMATS
from jaxswarm.outputs import file_name

_WILD = re.compile(r"[*?\[]")
_LOCAL = ("file", "local")
# What file systems call the time of a file's last change.
_TIMES = ("mtime", "LastModified", "last_modified", "updated", "created")


class Source(NamedTuple):
    """One log of a fleet.

    Attributes:
        address: With its protocol where it is not a local file.
        path: Below LOGS; names the log in all results.
        arm: Name of the arm.
        date: When it was logged; None: unknown.
        size: In bytes; logs of like size are worked on one after another.
    """

    address: str
    path: str
    arm: str
    date: datetime | None
    size: int

    @property
    def name(self) -> str:
        """Folder of its result: readable, and another one for every path."""
        stem = file_name(self.path.replace("/", "_")).rsplit(".", 1)[0]
        return f"{stem}-{hashlib.sha256(self.path.encode('utf-8', 'replace')).hexdigest()[:8]}"


def find_logs(where: str, pattern: re.Pattern | None = None) -> list[Source]:
    """All logs of a folder with what is below it, or of a glob, sorted by path.

    Args:
        where: Folder, file or glob, local or at an address.
        pattern: Rule for arm and date, see :mod:`jaxswarm.fleet.naming`.

    Raises:
        InputError: If the place cannot be reached or holds no log.
    """
    system, place = _reach(where)
    try:
        if _WILD.search(place):
            found, root = system.glob(place, detail=True), _steady(place)
        elif system.isdir(place):
            found, root = system.find(place, detail=True), place
        else:
            found, root = {place: system.info(place)}, str(PurePosixPath(place).parent)
    except FileNotFoundError:
        raise InputError(f"--fleet {where}: no such folder, file or glob of logs") from None
    except (
        Exception
    ) as error:  # every store has errors of its own: no rights, no network, no bucket
        raise InputError(f"--fleet {where}: cannot be listed ({_first_line(error)})") from error
    logs = [
        _source(system, path, str(PurePosixPath(path).relative_to(root)), info, pattern)
        for path, info in sorted(found.items())
        if info.get("type") == "file" and PurePosixPath(path).suffix.lower() in LOG_FORMATS
    ]
    if not logs:
        raise InputError(
            f"--fleet {where}: holds no log among {len(found)} files; known formats: "
            f"{', '.join(LOG_FORMATS)}"
        )
    return logs


def _source(system: Any, path: str, below: str, info: dict, pattern) -> Source:
    arm, date = arm_and_date(below, pattern)
    return Source(
        address=path if _is_local(system) else system.unstrip_protocol(path),
        path=below,
        arm=arm,
        date=date or _changed(info),
        size=int(info.get("size") or 0),
    )


def _changed(info: dict) -> datetime | None:
    """When a file was last changed, where no path tells a date."""
    told = next((info[name] for name in _TIMES if info.get(name)), None)
    if isinstance(told, int | float):
        return datetime.fromtimestamp(told).replace(microsecond=0)
    return told.replace(tzinfo=None, microsecond=0) if isinstance(told, datetime) else None


def _steady(place: str) -> str:
    """The folder above the first wild card of a glob."""
    return _WILD.split(place, maxsplit=1)[0].rpartition("/")[0] or "/"


def stamp(address: str) -> str:
    """What changes when a log does: digest of a local file, what a store tells of one elsewhere."""
    system, place = _reach(address)
    if not _is_local(system):
        return system.ukey(place)
    with open(place, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@contextmanager
def at_hand(address: str) -> Iterator[Path]:
    """A log as a local file: itself, or a copy that is gone afterwards."""
    system, place = _reach(address)
    if _is_local(system):
        yield Path(place)
        return
    with tempfile.TemporaryDirectory(prefix="jaxswarm-fleet-") as folder:
        copy = Path(folder) / PurePosixPath(place).name
        system.get_file(place, str(copy))
        yield copy


def _reach(address: str) -> tuple[Any, str]:
    import fsspec

    try:
        return fsspec.core.url_to_fs(str(address))
    except (ImportError, ValueError) as error:
        raise InputError(f"--fleet {address}: {_first_line(error)}") from None


def _is_local(system: Any) -> bool:
    known = (system.protocol,) if isinstance(system.protocol, str) else system.protocol
    return bool(set(known) & set(_LOCAL))


def _first_line(error: BaseException) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0][:200]
