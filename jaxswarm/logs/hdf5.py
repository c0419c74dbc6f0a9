"""HDF5: one log of arrays, in the file or in one of its groups; MAT files of version 7.3 are such files.

An array is known by its own name, wherever it stands: ``t``, ``q``, ``dq``, ``ddq``, ``tau``, ``effort``, or
MuJoCo's ``qpos`` and ``qvel``. A file whose groups hold several logs, such as episodes of a demonstration,
needs to be told which one. MATLAB stores arrays transposed, names as numbers and cells as references.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from jaxswarm.errors import InputError, nearest
from jaxswarm.logs.bounds import needed_arrays, refuse_large
from jaxswarm.logs.names import QUANTITIES, looks_like
from jaxswarm.logs.npz import joint_names
from jaxswarm.logs.table import Table

ENDINGS = (".h5", ".hdf5", ".hdf")
_OURS = {"qpos": "q", "qvel": "dq", "qacc": "ddq", "timestamp": "t", "timestamps": "t", "time": "t"}
_KNOWN = (*QUANTITIES, "t", "effort", "joints", *_OURS)
# How deep groups are followed, and how many arrays are looked at: what refers to itself has no end.
_DEPTH, _MOST = 12, 20_000
_SHOWN = 6


def read_hdf5(path: Path, part: str | None = None) -> Table:
    """Read the arrays of an HDF5 file into a table.

    Args:
        path: The file.
        part: Group that holds the log; None: the whole file.

    Returns:
        The table; arrays that are no numbers are listed as rejected.

    Raises:
        InputError: If h5py is missing, the group is not there, or the file holds several logs.
    """
    try:
        import h5py
    except ImportError:
        raise InputError(
            f"{path}: reading HDF5 (also MAT version 7.3) needs h5py. Install it: pip install "
            "'jaxswarm[formats]'."
        ) from None
    with h5py.File(path, "r") as file:
        found = _datasets(h5py, file)
        if part is not None:
            inside = part.strip("/") + "/"
            inner = {name: data for name, data in found.items() if name.startswith(inside)}
            if not inner:
                groups = sorted({name.rpartition("/")[0] for name in found} - {""})
                raise InputError(
                    f"{path}: no group {part!r} with arrays. {nearest(part, groups)} (--topic)"
                )
            found = inner
        columns = _by_name(path, found)
        where = {id(data): place for place, data in found.items()}
        places = {name: where[id(data)] for name, data in columns.items()}
        return replace(_table(path, file, columns), places=places)


def _datasets(h5py: Any, file: Any) -> dict[str, Any]:
    """Arrays by their whole path, without those that MATLAB keeps for cells."""
    found: dict[str, Any] = {}

    def walk(group: Any, path: str, depth: int) -> None:
        for name, item in group.items():
            if len(found) >= _MOST:
                return
            if not path and name.startswith("#"):
                continue
            if isinstance(item, h5py.Dataset):
                found[path + name] = item
            elif depth < _DEPTH:
                walk(item, f"{path}{name}/", depth + 1)

    walk(file, "", 0)
    return found


def _by_name(path: Path, found: dict[str, Any]) -> dict[str, Any]:
    """Arrays by the name of ours, or by their path where it is none."""
    columns: dict[str, Any] = {}
    places: dict[str, list[str]] = {}
    for place, data in found.items():
        name = place.rpartition("/")[2]
        known = name in _KNOWN or looks_like(name)
        short = _OURS.get(name, name)
        known = known and not (short != name and short in columns)
        places.setdefault(short if known else place, []).append(place)
        columns[short if known else place] = data
    several = next((rows for rows in places.values() if len(rows) > 1), None)
    if several:
        groups = [row.rpartition("/")[0] or "/" for row in several]
        more = f" and {len(groups) - _SHOWN} more" if len(groups) > _SHOWN else ""
        raise InputError(
            f"{path}: holds several logs, in {', '.join(groups[:_SHOWN])}{more}. Say which: --topic "
            f"{groups[0]}"
        )
    return columns


def _table(path: Path, file: Any, found: dict[str, Any]) -> Table:
    matlab = {name for name, data in found.items() if "MATLAB_class" in data.attrs}
    shapes = {
        name: data.shape[::-1] if name in matlab else data.shape for name, data in found.items()
    }
    shapes = {name: shape for name, shape in shapes.items() if shape is not None}
    needed, notes = needed_arrays(path, shapes)
    refuse_large(path, sum(found[name].nbytes for name in needed))
    columns: dict[str, np.ndarray] = {}
    rejected, joints = {}, None
    for name in (name for name in found if name in needed):
        data = found[name]
        if name == "joints":
            joints = joint_names(path, _names(file, data))
        elif data.dtype.kind not in "biuf" or data.dtype.names or _is_text(data):
            rejected[name] = f"{name} holds {data.dtype}, no real numbers."
        else:
            values = np.asarray(data[()])
            values = values.T if name in matlab else values
            wide = values.ndim == 2 and values.shape[0] == 1 < values.shape[1]
            values = values[0] if wide and name in matlab else values
            columns[name] = np.asarray(values, dtype=np.float64)
    return Table(str(path), columns, joints, rejected, notes=tuple(notes.values()))


def _is_text(data: Any) -> bool:
    return data.attrs.get("MATLAB_class") == b"char"


def _names(file: Any, data: Any) -> np.ndarray:
    """Names of joints: texts, or MATLAB's cells of characters."""
    values = np.atleast_1d(np.asarray(data[()])).ravel()
    if data.dtype.kind == "O" and len(values) and not isinstance(values[0], bytes | str):
        texts = ["".join(map(chr, np.asarray(file[cell][()]).ravel())) for cell in values]
    elif data.dtype.kind == "O":
        texts = [v.decode("utf-8") if isinstance(v, bytes) else str(v) for v in values]
    else:
        return values
    return np.array(texts, dtype=str)
