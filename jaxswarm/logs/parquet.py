"""Parquet: the columns of the CSV format, or list columns ``q``, ``tau`` (one entry per joint)."""

from pathlib import Path

import numpy as np

from jaxswarm.errors import InputError
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
        table = parquet.ParquetFile(handle).read()
    names = table.column_names
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{path}: column {name} appears twice. Keep one of them.")
    columns, rejected = {}, {}
    for name, column in zip(names, table.columns, strict=True):
        if name == "__index_level_0__":
            continue
        values = column.to_numpy()
        if values.dtype.kind == "O":
            values = _lists(values)
        numbers = None if values is None else as_numbers(values)
        if numbers is None:
            rejected[name] = f"{name} holds {column.type}, no real numbers of one length."
        else:
            columns[name] = numbers
    return Table(str(path), columns, rejected=rejected)


def _lists(values: np.ndarray) -> np.ndarray | None:
    """Rows of equal length as a matrix (T, k), nullable booleans and the like as (T,)."""
    cells = [np.asarray(np.nan if cell is None else cell) for cell in values]
    shapes = {cell.shape for cell in cells}
    if len(shapes) != 1 or any(cell.dtype.kind not in "biuf" for cell in cells):
        return None
    return np.stack(cells)
