"""Which files a command wrote into a folder, and whether they are still as it wrote them."""

import hashlib
import json
from pathlib import Path

MANIFEST = ".jaxswarm.json"


def read_sets(folder: Path) -> list[dict[str, str]]:
    """The sets written into a folder: name to digest; whatever cannot be read counts as nothing."""
    try:
        sets = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))["sets"]
        # A name with a separator could lead out of the folder.
        return [{n: str(d) for n, d in one.items() if n == Path(n).name} for one in sets]
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return []


def as_written(path: Path, digest: str | None) -> bool:
    """Whether a file is there and has a digest; None is that of nothing."""
    return digest is not None and path.is_file() and digest_of(path) == digest


def digest_of(path: Path) -> str:
    """SHA-256 of a file, as text."""
    return hashlib.sha256(path.read_bytes()).hexdigest()
