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
    """

    source: str
    columns: dict[str, np.ndarray]
    joints: tuple[str, ...] | None = None
    rejected: dict[str, str] = field(default_factory=dict)
    lines: np.ndarray | None = None
    notes: tuple[str, ...] = ()

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
