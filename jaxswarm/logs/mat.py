"""MAT files: variables, or fields of a structure, by the names and shapes of the NPZ format.

MATLAB has no vectors: a row (1, T) is read as (T,), and a column (T, 1) keeps its shape until it is
known how many joints the robot has. Files of version 7.3 are HDF5.
"""

from pathlib import Path

from jaxswarm.errors import InputError, nearest
from jaxswarm.logs.bounds import needed_arrays, refuse_large
from jaxswarm.logs.hdf5 import read_hdf5
from jaxswarm.logs.matfile import Other, Structure, Value, parse_mat
from jaxswarm.logs.names import looks_like
from jaxswarm.logs.npz import joint_names
from jaxswarm.logs.table import Table, as_numbers

_HDF5 = b"\x89HDF"


def read_mat(path: Path, part: str | None = None) -> Table:
    """Read a MAT file into a table of arrays.

    Args:
        path: File with variables ``t``, ``q``, ..., or with a structure that holds them.
        part: Structure that holds the log, ``outer.inner`` for one within another; None: the variables, or
            the only structure that holds a log.

    Returns:
        The table; variables that are no numbers are listed as rejected.

    Raises:
        InputError: If which structure is meant has to be said.
    """
    refuse_large(path, path.stat().st_size)
    content = path.read_bytes()
    if content.startswith(b"MATLAB 7.3") or _HDF5 in content[:8] + content[512:520]:
        return read_hdf5(path, None if part is None else part.replace(".", "/"))
    notes: dict[str, str] = {}

    def choose(shapes: dict[str, tuple[int, ...]], lengths: dict[str, int]) -> set[str]:
        needed, left_out = needed_arrays(path, shapes, lengths)
        notes.update(left_out)
        return needed

    found = parse_mat(content, choose)
    variables, where = _log_in(path, found, part)
    variables = _flat(variables)
    told = (f"The log is the structure {where}.",) if where else ()
    columns, rejected, joints = {}, {}, None
    for name, value in variables.items():
        if name == "joints":
            joints = _joints(path, value)
        elif isinstance(value, Other | Structure):
            kind = value.kind if isinstance(value, Other) else "a structure"
            rejected[name] = f"{name} holds {kind}, no real numbers."
        elif (numbers := as_numbers(value)) is None:
            rejected[name] = f"{name} holds characters, no real numbers."
        else:
            wide = numbers.ndim == 2 and numbers.shape[0] == 1 < numbers.shape[1]
            columns[name] = numbers[0] if wide else numbers
    return Table(str(path), columns, joints, rejected, notes=(*told, *notes.values()))


def _log_in(path: Path, found: dict[str, Value], part: str | None) -> tuple[dict[str, Value], str]:
    """The variables of the log, and the structure they are fields of."""
    structures = _structures(found, "")
    if part is not None:
        if part not in structures:
            raise InputError(
                f"{path}: no structure {part!r}. {nearest(part, structures)} (--topic)"
            )
        return structures[part], part
    if "t" in found or not structures:
        return found, ""
    logs = {
        name: fields
        for name, fields in structures.items()
        if "t" in fields or any(looks_like(field) for field in fields)
    }
    outermost = [name for name in structures if "." not in name]
    if not logs and len(outermost) == 1:
        return structures[outermost[0]], outermost[0]
    if len(logs) != 1:
        raise InputError(
            f"{path}: holds the structures {', '.join(logs or structures)}. Say which is the log: --topic "
            f"{next(iter(logs or structures))}"
        )
    ((name, fields),) = logs.items()
    return fields, name


def _structures(variables: dict[str, Value], prefix: str) -> dict[str, dict[str, Value]]:
    found = {}
    for name, value in variables.items():
        if isinstance(value, Structure):
            found[prefix + name] = value.fields
            found |= _structures(value.fields, f"{prefix}{name}.")
    return found


def _flat(variables: dict[str, Value]) -> dict[str, Value]:
    """Variables with the fields of structures among them, ``meas.pos``."""
    flat: dict[str, Value] = {}
    for name, value in variables.items():
        if isinstance(value, Structure) and value.fields:
            flat |= {f"{name}.{inner}": x for inner, x in _flat(value.fields).items()}
        else:
            flat[name] = value
    return flat


def _joints(path: Path, value: Value) -> tuple[str, ...]:
    if isinstance(value, Other | Structure):
        kind = value.kind if isinstance(value, Other) else "a structure"
        raise InputError(
            f"{path}: joints holds {kind}. Save names as a cell array: joints = cellstr(joints)."
        )
    return joint_names(path, value)
