"""NPZ archives of numpy arrays: ``t`` (T,), ``q``, ``tau``, ... (T, n), and names in ``joints``.

Pickled objects are never loaded: a log is numbers.
"""

from pathlib import Path
from typing import BinaryIO

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.logs.table import Table, as_numbers


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
    archive = np.load(handle, allow_pickle=False)
    if isinstance(archive, np.ndarray):
        raise InputError(
            f"{path}: holds a single array. Write a log with numpy.savez(path, t=t, q=q, ...)."
        )
    columns, rejected, joints = {}, {}, None
    with archive:
        for name in archive.files:
            if archive.files.count(name) > 1:
                raise InputError(
                    f"{path}: key {name} appears twice in the archive. Keep one of them."
                )
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
    return Table(str(path), columns, joints, rejected)


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
