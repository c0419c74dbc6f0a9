"""Texts that users name: models, results, limits, columns. What is no file, or far too large, is refused.

Reading a device or a pipe would never end, and a text of gigabytes takes several times that as numbers.
"""

import stat
from pathlib import Path

from jaxswarm.errors import InputError

# The largest model, of three hundred joints with the covariance of its parameters, has half of it.
LARGEST = 100_000_000


def read_document(path: str | Path) -> str:
    """The text of a file in UTF-8.

    Args:
        path: The file.

    Raises:
        InputError: If it is a device or a pipe, or larger than :data:`LARGEST`.
        OSError: If it cannot be read.
        UnicodeDecodeError: If it is no text.
    """
    path = Path(path)
    found = path.stat()
    if not stat.S_ISREG(found.st_mode) and not stat.S_ISDIR(found.st_mode):
        raise InputError(f"{path}: is no file but a device or a pipe. Give the file itself.")
    if found.st_size > LARGEST:
        raise InputError(
            f"{path}: has {found.st_size / 1e6:.0f} MB, at most {LARGEST / 1e6:.0f} MB are read. Check "
            "whether it is the file you mean."
        )
    return path.read_text(encoding="utf-8")
