"""What a file format yields before anyone asks about robots: named columns of numbers.

Readers of tables (CSV, Parquet) fill one-dimensional columns, readers of arrays (NPZ, MAT, MCAP)
also (T, k) arrays with optional joint names. Both meet here, so that names and values are checked
once.
"""

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True, eq=False)
class Table:
    """The content of one file.

    Attributes:
        source: File name as given by the user.
        columns: Name to float64 array, shape (T,) or (T, k).
        joints: Names of the k columns of two-dimensional arrays, or None if the file has none.
        rejected: Name to reason, for columns that hold something else than numbers; harmless unless
            the column turns out to be needed.
        lines: Line in the file (from 1) of each row, or None where a format has no lines.
        notes: Sentences about what the reader did.
        places: Where columns stand in a file of groups, ``run/meas/pos``, for those known by another name.
    """

    source: str
    columns: dict[str, np.ndarray]
    joints: tuple[str, ...] | None = None
    rejected: dict[str, str] = field(default_factory=dict)
    lines: np.ndarray | None = None
    notes: tuple[str, ...] = ()
    places: dict[str, str] = field(default_factory=dict)

    def column_of(self, name: str) -> str:
        """The column that a user means: by its name, its place, or the end of the one place that ends so.

        >>> Table("log.mat", {"t": np.zeros(2)}, places={"t": "run/time"}).column_of("run.time")
        't'
        """
        if name in self.columns:
            return name
        end = "." + name.replace("/", ".")
        named = {column: self.places.get(column, column) for column in self.columns}
        found = [c for c, place in named.items() if f".{place.replace('/', '.')}".endswith(end)]
        return found[0] if len(found) == 1 else name

    def row(self, index: int) -> str:
        """Name the row at ``index`` (from 0) as a user counts: from 1, with its line in the file.

        >>> Table("log.csv", {}, lines=np.array([2, 3, 5])).row(2)
        'row 3 (line 5)'
        """
        if self.lines is None:
            return f"row {index + 1}"
        return f"row {index + 1} (line {self.lines[index]})"


def as_numbers(values: np.ndarray) -> np.ndarray | None:
    """Convert booleans, integers and real floats to float64; None for anything else.

    >>> as_numbers(np.array([1, 2]))
    array([1., 2.])
    >>> as_numbers(np.array(["a"])) is None
    True
    """
    if values.dtype.kind not in "biuf":
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        return np.asarray(values, dtype=np.float64)
