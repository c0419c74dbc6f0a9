"""Where a result comes from: digests of its inputs, versions, options; nothing that changes from run to run."""

import hashlib
import platform
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

_PLAIN = (bool, int, float, str)
_PACKAGES = ("jaxswarm", "jax", "jaxlib", "numpy", "scipy")


def provenance(inputs: Sequence[Path], options: dict) -> dict:
    """Digests of input files by name, versions of what computed, and the options it was given.

    Args:
        inputs: Files that were read.
        options: Options by name, as text or numbers.
    """
    return {
        "inputs": [
            {"name": Path(p).name, "sha256": _digest(Path(p)), **_read_as(p)} for p in inputs
        ],
        "versions": {"python": platform.python_version(), **{n: version(n) for n in _PACKAGES}},
        "options": {
            k: v if v is None or isinstance(v, _PLAIN) else str(v) for k, v in options.items()
        },
    }


def _digest(path: Path) -> str:
    """Digest of a file, or of the names and contents in a folder such as that of a recording."""
    if path.is_file():
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    whole = hashlib.sha256()
    for part in sorted(part for part in path.rglob("*") if part.is_file()):
        whole.update(f"{part.relative_to(path)}\0{_digest(part)}\n".encode())
    return whole.hexdigest()


def _read_as(path: object) -> dict[str, str]:
    """How a log was read, where the user said more than its path."""
    reading = getattr(path, "reading", None)
    return {} if reading is None else {"read_as": str(reading)}
