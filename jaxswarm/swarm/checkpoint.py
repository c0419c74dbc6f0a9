"""Checkpoints: a tree of arrays on the disk, whole or not at all; ``resume`` goes on from one.

A state is written as one ``.npz``: every leaf under its path in the tree, and a JSON header with
what it belongs to. The file is written beside its place, flushed to the disk and renamed, so that
at any moment the place holds a whole file, the old or the new one. Reading compares every leaf with
a prototype and refuses what does not fit.
"""

import json
import os
import platform
from pathlib import Path
from typing import Any

import jax
import numpy as np

from jaxswarm.errors import InputError

__all__ = ["header_of", "restore", "save"]

FORMAT = 3
HEADER = "__header__"


def save(path: str | os.PathLike, tree: Any, **header: Any) -> None:
    """Write a tree of arrays, whole or not at all.

    Args:
      path: file to (re)place; its folder must exist.
      tree: any pytree of arrays, such as ``result.state``.
      **header: JSON values kept with it and compared by :func:`restore`.
    """
    path = Path(path)
    text = json.dumps({"format": FORMAT, **header}, sort_keys=True)
    arrays: dict[str, Any] = {HEADER: np.array(text)}
    arrays |= {name: np.asarray(leaf) for name, leaf in _named_leaves(jax.device_get(tree)).items()}
    mark = f".{path.name}.{platform.node() or 'here'}-"
    _sweep(path.parent, mark)
    part = path.with_name(f"{mark}{os.getpid()}.part")
    try:
        with open(part, "wb") as file:
            np.savez(file, **arrays)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)  # the rename itself must reach the disk
    finally:
        os.close(folder)


def _sweep(folder: Path, mark: str) -> None:
    """Remove unfinished files of this checkpoint whose process, on this machine, is no more."""
    for name in os.listdir(folder) if os.name != "nt" else ():  # there, signal 0 ends a process
        process = name.removeprefix(mark).removesuffix(".part")
        if name != f"{mark}{process}.part" or not process.isdigit():
            continue
        try:
            os.kill(int(process), 0)
        except (ProcessLookupError, OverflowError):
            (folder / name).unlink(missing_ok=True)
        except OSError:
            pass  # it lives, but is another user's


def restore(path: str | os.PathLike, like: Any, **header: Any) -> Any:
    """Read what :func:`save` wrote, against a prototype.

    Args:
      path: file to read.
      like: tree of arrays or ``jax.ShapeDtypeStruct`` with the structure, shapes and dtypes
        expected, e.g. ``jax.eval_shape(optimizer.init, key, space)``.
      **header: what the file must say of itself.

    Raises:
      InputError: not a checkpoint, or of another search: names the first difference.
    """
    stored, found = _read(path)
    for name, expected in {"format": FORMAT, **header}.items():
        if found.get(name) != expected:
            raise InputError(
                f"{path}: {name} is {found.get(name)!r}, expected {expected!r}: it belongs to "
                "another search; remove it or give another path."
            )
    wanted = _named_leaves(like)
    for name in sorted(wanted.keys() ^ stored.keys()):
        where = "is missing" if name in wanted else "is not expected"
        raise InputError(f"{path}: {name} {where}: it belongs to another optimizer or version.")
    for name, leaf in wanted.items():
        here = stored[name]
        if here.shape != leaf.shape or here.dtype != leaf.dtype:
            raise InputError(
                f"{path}: {name} has shape {here.shape} and dtype {here.dtype}, expected "
                f"{leaf.shape} and {leaf.dtype}."
            )
    leaves = [jax.device_put(stored[name]) for name in wanted]
    return jax.tree_util.tree_unflatten(jax.tree_util.tree_structure(like), leaves)


def header_of(path: str | os.PathLike) -> dict[str, Any]:
    """What a checkpoint says of itself."""
    return _read(path)[1]


def _read(path):
    try:
        with np.load(path, allow_pickle=False) as file:
            stored = {name: file[name] for name in file.files}
        return stored, dict(json.loads(str(stored.pop(HEADER))))
    except Exception as error:  # parsers raise anything on damaged bytes
        raise InputError(f"{path} is no checkpoint of jaxswarm ({error}).") from error


def _named_leaves(tree: Any) -> dict[str, Any]:
    leaves = jax.tree_util.tree_flatten_with_path(tree)[0]
    return {jax.tree_util.keystr(path): leaf for path, leaf in leaves}
