"""CSV with one header line, separated by commas (semicolons and tabs are understood too).

Numbers are parsed in C and in pieces; only if that fails is the text walked cell by cell, to name the row,
the line and the column of what is wrong. A header may start with ``#``, as ``numpy.savetxt`` writes it.
Between semicolons or tabs a comma in a number is the decimal point of half the world, and is read so.
Time may be written as dates and hours (ISO 8601).
"""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.logs.bounds import refuse_large
from jaxswarm.logs.csv_lines import Numbered, header_of, split, with_points
from jaxswarm.logs.csv_numbers import of_numbers
from jaxswarm.logs.stamps import seconds
from jaxswarm.logs.table import Table

_DATE = re.compile(r"\d{4}-\d\d-\d\d[ T]\d\d:\d\d")
_ZONE = re.compile(r"(Z|[+-]\d\d:?\d\d)$")


def read_csv(path: Path) -> Table:
    """Read a CSV file into a table of columns.

    Args:
        path: File in UTF-8.

    Returns:
        The table; columns that hold text are listed as rejected. An empty cell reads as NaN.

    Raises:
        InputError: If the file is no text, is empty, has two columns of one name, or a row has
            more or fewer cells than the header.
    """
    table = of_numbers(path) or _of_text(path)
    if "" not in table.columns and "" not in table.rejected:
        return table
    columns = {name: x for name, x in table.columns.items() if name}
    rejected = {name: why for name, why in table.rejected.items() if name}
    note = "A column without a name in the header was left out."
    return replace(table, columns=columns, rejected=rejected, notes=(*table.notes, note))


def _of_text(path: Path) -> Table:
    """The table of a file that holds more than numbers, or refuses it with what is wrong and where."""
    header, names, delimiter, body = header_of(path, _lines(path))
    if not body:
        raise InputError(f"{path}: only a header (line {header}), no data rows. Was the log cut?")
    body, commas = with_points(path, body) if delimiter != "," else (body, [])
    columns, rejected, notes = _walk(path, names, delimiter, body)
    lines = np.array([number for number, _ in body])
    return Table(str(path), columns, None, rejected, lines, (*commas, *notes))


def _lines(path: Path) -> Numbered:
    """Lines that are not blank, with their numbers from 1."""
    refuse_large(path, path.stat().st_size)
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path}: no text at byte {error.start}. A CSV log is text in UTF-8: save it so, or "
            "give the file the ending of what it is."
        ) from None
    if "\x00" in text:
        raise InputError(
            f"{path}: holds binary data, a CSV log is text. Give it the ending of what it is."
        )
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    return [(number, line) for number, line in enumerate(lines, start=1) if line.strip()]


def _walk(
    path: Path, names: list[str], delimiter: str, body: Numbered
) -> tuple[dict, dict, list[str]]:
    """Parse cell by cell: ragged rows are refused, columns with text set aside with the reason, and notes."""
    rows = []
    for row, (number, line) in enumerate(body, start=1):
        cells = split(path, line, delimiter, number)
        if len(cells) != len(names):
            last = " If the recording was cut, delete this last line." if row == len(body) else ""
            raise InputError(
                f"{path}: row {row} (line {number}) has {len(cells)} cells, the header has "
                f"{len(names)}.{last}"
            )
        rows.append(cells)
    columns, rejected, notes = {}, {}, []
    for name, cells in zip(names, map(list, zip(*rows, strict=True)), strict=True):
        if name and (stamps := _stamps(name, cells)) is not None:
            columns[name], note = stamps
            notes += note
            continue
        values = np.empty(len(cells))
        for row, cell in enumerate(cells):
            try:
                values[row] = _number(cell)
            except ValueError:
                hint = " Use a decimal point." if "," in cell else ""
                rejected[name] = (
                    f"row {row + 1} (line {body[row][0]}), column {name} holds {cell[:40]!r}, no "
                    f"number.{hint}"
                )
                break
        else:
            columns[name] = values
    return columns, rejected, notes


def _number(cell: str) -> float:
    """A number as written by a data logger; Python's own ``1_000`` is none."""
    if "_" in cell:
        raise ValueError(cell)
    return float(cell) if cell.strip() else np.nan


def _stamps(name: str, cells: list[str]) -> tuple[np.ndarray, list[str]] | None:
    """Dates and hours as seconds from the first, and a note; None for anything else."""
    texts = [cell.strip().strip('"') for cell in cells]
    if not _DATE.match(texts[0]):
        return None
    try:
        # Hours of one zone: its name at the end of every cell says nothing about intervals.
        zones = {zone[0] if (zone := _ZONE.search(text)) else "" for text in texts}
        stamps = np.array([_ZONE.sub("", text) for text in texts], dtype="datetime64[ns]")
    except ValueError:
        return None
    return None if len(zones) > 1 else seconds(name, stamps)
