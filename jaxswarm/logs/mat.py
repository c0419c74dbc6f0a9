"""MAT files of version 5 to 7.2 (``save -v7``): the names and shapes of the NPZ format.

MATLAB has no vectors: a row (1, T) is read as (T,), and a column (T, 1) keeps its shape until it is
known how many joints the robot has.
"""

from pathlib import Path

from jaxswarm.errors import InputError
from jaxswarm.logs.bounds import needed_arrays, refuse_large
from jaxswarm.logs.matfile import Other, parse_mat
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
    refuse_large(path, path.stat().st_size)
    content = path.read_bytes()
    if content.startswith(b"MATLAB 7.3") or b"HDF" in content[:8] + content[512:520]:
        raise InputError(
            f"{path}: MAT version 7.3 is not read. Save it in MATLAB with save('log.mat', '-v7', "
            "'t', 'q', 'tau')."
        )
    notes: dict[str, str] = {}

    def choose(shapes: dict[str, tuple[int, ...]], lengths: dict[str, int]) -> set[str]:
        needed, left_out = needed_arrays(path, shapes, lengths)
        notes.update(left_out)
        return needed

    variables = parse_mat(content, choose)
    structures = [name for name, value in variables.items() if _is_structure(value)]
    if "t" not in variables and structures:
        raise InputError(
            f"{path}: the log is inside the structure {structures[0]}. Save its fields as "
            f"variables: save('log.mat', '-v7', '-struct', '{structures[0]}')."
        )
    columns, rejected, joints = {}, {}, None
    for name, value in variables.items():
        if name == "joints":
            joints = _joints(path, value)
        elif isinstance(value, Other):
            rejected[name] = f"{name} holds {value.kind}, no real numbers."
        elif (numbers := as_numbers(value)) is None:
            rejected[name] = f"{name} holds characters, no real numbers."
        else:
            wide = numbers.ndim == 2 and numbers.shape[0] == 1 < numbers.shape[1]
            columns[name] = numbers[0] if wide else numbers
    return Table(str(path), columns, joints, rejected, notes=tuple(notes.values()))


def _is_structure(value) -> bool:
    return isinstance(value, Other) and value.kind == "a structure"


def _joints(path: Path, value) -> tuple[str, ...]:
    if isinstance(value, Other):
        raise InputError(
            f"{path}: joints holds {value.kind}. Save names as a cell array: joints = cellstr(joints)."
        )
    return joint_names(path, value)
