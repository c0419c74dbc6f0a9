"""MAT files of version 5 to 7.2 (``save -v7``): the names and shapes of the NPZ format.

MATLAB has no vectors: a row (1, T) is read as (T,), and a column (T, 1) keeps its shape until it is
known how many joints the robot has.
"""

from pathlib import Path

import numpy as np
from scipy import io

from jaxswarm.errors import InputError
from jaxswarm.logs.npz import joint_names
from jaxswarm.logs.table import Table, as_numbers


def read_mat(path: Path) -> Table:
    """Read a MAT file into a table of arrays.

    Args:
        path: File of version 5 to 7.2 with variables ``t``, ``q``, ...

    Returns:
        The table; variables that are no numbers are listed as rejected.

    Raises:
        InputError: If the file is of version 7.3 or keeps the log inside one structure.
    """
    if path.read_bytes()[:128].startswith(b"MATLAB 7.3"):
        raise InputError(
            f"{path}: MAT version 7.3 is not read. Save it in MATLAB with save('log.mat', '-v7', "
            "'t', 'q', 'tau')."
        )
    content = io.loadmat(path)
    content = {name: values for name, values in content.items() if not name.startswith("__")}
    structures = [
        name
        for name, values in content.items()
        if getattr(values, "dtype", None) and values.dtype.names
    ]
    if "t" not in content and structures:
        raise InputError(
            f"{path}: the log is inside the structure {structures[0]}. "
            f"Save its fields as variables: save('log.mat', '-v7', '-struct', '{structures[0]}')."
        )
    columns, rejected, joints = {}, {}, None
    for name, values in content.items():
        values = np.asarray(values)
        if name == "joints":
            joints = joint_names(path, _strings(values))
        elif (numbers := as_numbers(values)) is None:
            rejected[name] = f"{name} holds {values.dtype}, no real numbers."
        else:
            wide = numbers.ndim == 2 and numbers.shape[0] == 1 < numbers.shape[1]
            columns[name] = numbers[0] if wide else numbers
    return Table(str(path), columns, joints, rejected)


def _strings(values: np.ndarray) -> np.ndarray:
    """A cell array of names, or a matrix of characters, as an array of strings."""
    if values.dtype.kind == "O":
        cells = [np.asarray(cell).ravel() for cell in values.ravel()]
        if all(cell.dtype.kind == "U" and cell.size == 1 for cell in cells):
            return np.array([cell[0] for cell in cells])
        return values
    return values.ravel() if values.dtype.kind == "U" else values
