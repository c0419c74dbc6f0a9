"""Writing results: a folder that is checked before the work and filled only after it, file by file whole."""

import json
import os
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from jaxswarm.errors import InputError


def check_folder(folder: Path) -> Path:
    """Refuse an output folder that could not be written, before any work is done; create nothing.

    Raises:
        InputError: If the path or the nearest existing parent is no writable folder.
    """
    folder = Path(folder)
    parent = folder
    while not parent.exists() and parent != parent.parent:
        parent = parent.parent
    if not parent.is_dir():
        raise InputError(f"--out {folder}: {parent} is not a folder; choose another output folder")
    try:
        with tempfile.TemporaryFile(dir=parent):
            pass
    except OSError as error:
        raise InputError(
            f"--out {folder}: cannot write there ({error.strerror}); choose another output folder"
        ) from None
    return folder


def write_files(folder: Path, files: dict[str, str | bytes | Callable[[Path], None]]) -> list[Path]:
    """Write files into a folder, each whole or not at all.

    Args:
        folder: Created if missing.
        files: Content by name: text, bytes, or a function that writes to the path it is given.

    Returns:
        The paths, in order.
    """
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        done = []
        for name, content in files.items():
            handle, temporary = tempfile.mkstemp(dir=folder, suffix=Path(name).suffix)
            os.close(handle)
            part = Path(temporary)
            try:
                if callable(content):
                    content(part)
                elif isinstance(content, bytes):
                    part.write_bytes(content)
                else:
                    part.write_text(content, encoding="utf-8")
                part.chmod(0o644)
                os.replace(part, folder / name)
            finally:
                part.unlink(missing_ok=True)
            done.append(folder / name)
    except OSError as error:
        raise InputError(
            f"--out {folder}: cannot write ({error.strerror}); choose another output folder"
        ) from None
    return done


def to_json(content) -> str:
    """JSON text of nested dicts, lists, numbers and arrays; NaN and infinity become null."""
    return json.dumps(_plain(content), indent=1, ensure_ascii=False) + "\n"


def _plain(x):
    if isinstance(x, dict):
        return {str(k): _plain(v) for k, v in x.items()}
    if isinstance(x, list | tuple):
        return [_plain(v) for v in x]
    if isinstance(x, np.ndarray) or hasattr(x, "__jax_array__") or hasattr(x, "device"):
        return _plain(np.asarray(x).tolist())
    if isinstance(x, np.generic):
        return _plain(x.item())
    if isinstance(x, float) and not np.isfinite(x):
        return None
    return x
