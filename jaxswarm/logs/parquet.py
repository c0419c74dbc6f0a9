"""Parquet: the columns of the CSV format, or list columns ``q``, ``tau`` (one entry per joint).

Time stamps and durations read as seconds, stamps from the first one, in whole nanoseconds before that.
"""

from collections.abc import Iterator
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.logs.bounds import refuse_large
from jaxswarm.logs.stamps import seconds
from jaxswarm.logs.table import Table, as_numbers


def read_parquet(path: Path) -> Table:
    """Read a Parquet file into a table of columns.

    Args:
        path: File with numeric columns; nulls read as NaN.

    Returns:
        The table; columns that are no numbers are listed as rejected.

    Raises:
        InputError: If pyarrow is missing or two columns have one name.
    """
    try:
        import pyarrow.parquet as parquet
    except ImportError:
        raise InputError(
            f"{path}: reading Parquet needs pyarrow. Install it: pip install 'jaxswarm[formats]'."
        ) from None
    # A file handle instead of a name: pyarrow would read "a=1" folders in the path as columns.
    with path.open("rb") as handle:
        file = parquet.ParquetFile(handle)
        fields = {}
        for field in file.schema_arrow:
            if field.name in fields:
                raise InputError(f"{path}: column {field.name} appears twice. Keep one of them.")
            fields[field.name] = field.type
        numeric = [name for name, kind in fields.items() if _may_be_numbers(kind)]
        _refuse_large_columns(path, file.metadata, numeric)
        columns, notes = {}, []
        rejected = {
            name: f"{name} holds {kind}, no real numbers of one length."
            for name, kind in fields.items()
            if name not in numeric
        }
        for name in numeric:
            if name == "__index_level_0__":
                continue
            # One column at a time: what is decoded of a long log is as large as what is made of it.
            column = file.read(columns=[name]).column(name)
            numbers, note = _numbers(name, column)
            notes += note
            if numbers is None:
                rejected[name] = f"{name} holds {column.type}, no real numbers of one length."
            else:
                columns[name] = numbers
    return Table(str(path), columns, rejected=rejected, notes=tuple(notes))


def _numbers(name: str, column: Any) -> tuple[np.ndarray | None, list[str]]:
    """A column of Arrow as numbers, (T,) or (T, k), and notes; None where it holds something else."""
    matrix = _matrix(column)
    if matrix is not None:
        return matrix, []
    values = column.to_numpy()
    notes: list[str] = []
    if values.dtype.kind in "Mm":
        values, notes = seconds(name, values)
    elif values.dtype.kind == "O":
        values = _lists(values)
    return None if values is None else as_numbers(values), notes


def _matrix(column: Any) -> np.ndarray | None:
    """Complete rows of equal length as a matrix (T, k), without an object for each; None for all else."""
    import pyarrow as arrow

    kind, types = column.type, arrow.types
    if not (types.is_list(kind) or types.is_large_list(kind) or types.is_fixed_size_list(kind)):
        return None
    if not (types.is_integer(kind.value_type) or types.is_floating(kind.value_type)):
        return None
    parts = [chunk for chunk in column.chunks if len(chunk)]
    width = len(parts[0][0]) if parts and parts[0][0].is_valid else 0
    rows = [chunk.flatten() for chunk in parts]
    whole = all(chunk.null_count == 0 for chunk in (*parts, *rows))
    even = whole and all(
        bool((chunk.value_lengths().to_numpy(zero_copy_only=False) == width).all())
        for chunk in parts
    )
    if not width or not even:
        return None
    return as_numbers(np.concatenate([row.to_numpy() for row in rows]).reshape(-1, width))


def _may_be_numbers(kind) -> bool:
    """Whether a column of this type can be read as numbers at all."""
    import pyarrow as arrow

    types = arrow.types
    lists = (types.is_list, types.is_large_list, types.is_fixed_size_list)
    if any(check(kind) for check in lists):
        return _may_be_numbers(kind.value_type)
    if types.is_dictionary(kind):
        return _may_be_numbers(kind.value_type)
    numbers = (
        *(types.is_integer, types.is_floating, types.is_boolean, types.is_null),
        *(types.is_timestamp, types.is_duration, types.is_decimal),
    )
    return any(check(kind) for check in numbers)


def _refuse_large_columns(path: Path, metadata, names: list[str]) -> None:
    """Add up the values of columns, which a few bytes can repeat a billion times."""
    count = 0
    for group in range(metadata.num_row_groups):
        row_group = metadata.row_group(group)
        for k in range(row_group.num_columns):
            column = row_group.column(k)
            # A list column "q" is stored as "q.list.element".
            path_parts = column.path_in_schema.split(".")
            if any(".".join(path_parts[: n + 1]) in names for n in range(len(path_parts))):
                count += max(column.num_values, row_group.num_rows)
    refuse_large(path, 8 * count)


def _lists(values: np.ndarray) -> np.ndarray | None:
    """Rows of equal length as a matrix (T, k), nullable booleans and the like as (T,)."""
    cells = [np.asarray(float(c) if isinstance(c, Decimal) else c) for c in _without_none(values)]
    shapes = {cell.shape for cell in cells}
    if len(shapes) != 1 or any(cell.dtype.kind not in "biuf" for cell in cells):
        return None
    return np.stack(cells)


def _without_none(values: np.ndarray) -> Iterator[Any]:
    return (np.nan if cell is None else cell for cell in values)
