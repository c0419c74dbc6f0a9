"""Files that are being written: hidden beside their places, and removed once their process is gone."""

import os
from pathlib import Path

_PART = ".jaxswarm-part-"


def mark(machine: str) -> str:
    """Prefix of unfinished files: the machine and the process they belong to.

    Args:
        machine: Its name, fit for a file name.
    """
    return f"{_PART}{machine}-{os.getpid()}-"


def sweep(folder: Path, machine: str) -> None:
    """Remove unfinished files of processes of this machine that are no more."""
    own = f"{_PART}{machine}-"
    for path in folder.glob(f"{_PART}*"):
        process = path.name.removeprefix(own).split("-")[0]
        if path.name.startswith(own) and process.isdigit() and not _alive(int(process)):
            path.unlink(missing_ok=True)


def _alive(process: int) -> bool:
    if os.name == "nt":  # there, signal 0 ends a process
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        pass  # it lives, but is another user's
    return True
