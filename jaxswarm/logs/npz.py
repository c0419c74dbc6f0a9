"""NPZ archives of numpy arrays: ``t`` (T,), ``q``, ``tau``, ... (T, n), and names in ``joints``.

Pickled objects are never loaded: a log is numbers.
"""

import zipfile
from pathlib import Path
from typing import BinaryIO

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.logs.bounds import needed_arrays
from jaxswarm.logs.table import Table, as_numbers

# A file of a single array begins so, and so does every array of an archive.
_SINGLE = b"\x93NUMPY"
_HEADERS = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


def read_npz(path: Path) -> Table:
    """Read an NPZ archive into a table of arrays.

    Args:
        path: File written by ``numpy.savez`` or ``numpy.savez_compressed``.

    Returns:
        The table; arrays that are no numbers are listed as rejected.

    Raises:
        InputError: If the file is no NPZ archive, holds one name twice, or holds pickled objects.
    """
    with path.open("rb") as handle:
        return _read(path, handle)


def _read(path: Path, handle: BinaryIO) -> Table:
    if handle.read(len(_SINGLE)) == _SINGLE:
        raise InputError(
            f"{path}: holds a single array. Write a log with numpy.savez(path, t=t, q=q, ...)."
        )
    handle.seek(0)
    if not zipfile.is_zipfile(handle):  # numpy would take it for a pickle, and advise to load that
        raise InputError(
            f"{path}: is no NPZ archive, or one cut short. Write the file again, or check its ending."
        )
    handle.seek(0)
    archive = np.load(handle, allow_pickle=False)
    columns, rejected, joints = {}, {}, None
    with archive:
        needed, notes = needed_arrays(path, *_declared(archive.zip))
        for name in archive.files:
            if archive.files.count(name) > 1:
                raise InputError(
                    f"{path}: key {name} appears twice in the archive. Keep one of them."
                )
            if name not in needed:
                continue
            try:
                values = archive[name]
            except ValueError as error:
                if "allow_pickle" not in str(error):
                    raise
                raise InputError(
                    f"{path}: key {name} holds Python objects, which are not loaded for safety. "
                    "Save arrays of numbers (for names: numpy.array(names, dtype=str))."
                ) from None
            if name == "joints":
                joints = joint_names(path, values)
            elif (numbers := as_numbers(values)) is None:
                rejected[name] = f"{name} holds {values.dtype}, no real numbers."
            else:
                columns[name] = numbers
    return Table(str(path), columns, joints, rejected, notes=tuple(notes.values()))


def _declared(archive: zipfile.ZipFile) -> tuple[dict[str, tuple[int, ...]], dict[str, int]]:
    """Shapes of the arrays by name, and the bytes of those that are no numbers, from their headers."""
    shapes: dict[str, tuple[int, ...]] = {}
    sizes: dict[str, int] = {}
    for member in archive.namelist():
        name = member.removesuffix(".npy")
        shapes[name] = ()
        with archive.open(member) as file:
            if file.read(len(_SINGLE)) != _SINGLE:
                sizes[name] = archive.getinfo(member).file_size  # no array: read as it stands
                continue
            version = tuple(file.read(2))
            read = _HEADERS.get(version)  # type: ignore[arg-type]  # what is cut has no version
            if read is None:
                raise ValueError(f"{name} is of the unknown NPY version {version}")
            shapes[name], _, kind = read(file)
            if kind.kind not in "biuf":
                sizes[name] = kind.itemsize * int(np.prod(shapes[name], dtype=object))
    return shapes, sizes


def joint_names(path: Path, values: np.ndarray) -> tuple[str, ...]:
    """Convert the array ``joints`` to names, or refuse it."""
    if values.dtype.kind not in "US" or values.ndim > 1:
        raise InputError(
            f"{path}: joints holds {values.dtype} of shape {values.shape}, expected a list of "
            "names. Leave it out if the columns are in the robot's order."
        )
    if values.dtype.kind == "S":
        values = np.char.decode(values, "utf-8")
    return tuple(str(name).strip() for name in np.atleast_1d(values))
