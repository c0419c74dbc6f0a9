"""Writing one log in many ways: the files that the variants are made of."""

from collections.abc import Callable
from functools import cached_property
from pathlib import Path

import numpy as np

from benchmarks.brought.formats import Columns, arrays, columns, text
from jaxswarm.logs import Log, LogChoice, parse_reading


class Files:
    """A log and the folder its files go to."""

    def __init__(self, log: Log, folder: Path):
        self.log, self.folder = log, folder

    @cached_property
    def plain(self) -> Columns:
        """Columns as the project names them."""
        return columns(self.log)

    @cached_property
    def whole(self) -> dict:
        """Arrays t (T,), q and tau (T, n)."""
        return arrays(self.log)

    @cached_property
    def stamps(self) -> np.ndarray:
        """The clock as dates."""
        start = np.datetime64("2026-03-01T08:00:00", "ns")
        return start + (self.whole["t"] * 1e9).round().astype("timedelta64[ns]")

    def said(self, path: Path, *words: str | None) -> LogChoice:
        """A file with what its reader is told: columns, topic, side, effort."""
        return LogChoice(path, parse_reading(*words))

    def csv_of(self, table: Columns, **how: str) -> Path:
        """A text file of columns."""
        return text(self.folder / "log.csv", table, **how)

    def dated(self) -> Path:
        """A text file whose clock is dates and hours."""
        path = self.csv_of(self.plain)
        lines = path.read_text().splitlines()
        dates = [str(stamp).replace("T", " ") for stamp in self.stamps]
        rows = zip(dates, lines[1:], strict=True)
        cells = [",".join([date, *line.split(",")[1:]]) for date, line in rows]
        path.write_text("\n".join([lines[0], *cells]))
        return path

    def savetxt(self) -> Path:
        """A text file as NumPy writes it."""
        table = np.column_stack(list(self.plain.values()))
        path = self.folder / "log.csv"
        np.savetxt(path, table, delimiter=",", header=",".join(self.plain))
        return path

    def raw(self, change: Callable[[bytes], bytes]) -> Path:
        """A text file whose bytes were changed."""
        path = self.csv_of(self.plain)
        path.write_bytes(change(path.read_bytes()))
        return path

    def npz(self, content: dict) -> Path:
        """A file of named arrays."""
        np.savez(self.folder / "log.npz", **content)
        return self.folder / "log.npz"
