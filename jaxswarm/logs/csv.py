"""CSV with one header line, separated by commas (semicolons and tabs are understood too).

Numbers are parsed in C; only if that fails is the text walked cell by cell, to name the row, the
line and the column of what is wrong. A header may start with ``#``, as ``numpy.savetxt`` writes it.
Between semicolons or tabs a comma in a number is the decimal point of half the world, and is read so.
Time may be written as dates and hours (ISO 8601).
"""

import csv
import re
from pathlib import Path

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.logs.bounds import refuse_large
from jaxswarm.logs.stamps import seconds
from jaxswarm.logs.table import Table

# A decimal comma between digits; a number with a point and a comma.
_COMMA = re.compile(r"(?<![\d,])([+-]?\d*),(\d+)(?![\d,])")
_DATE = re.compile(r"\d{4}-\d\d-\d\d[ T]\d\d:\d\d")
_ZONE = re.compile(r"(Z|[+-]\d\d:?\d\d)$")
_BOTH = re.compile(r"\d[\d]*(?:\.\d+,|,\d+\.)\d+")


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
    numbered = _lines(path)
    header_line, names, delimiter, body = _header(path, numbered)
    if not body:
        raise InputError(
            f"{path}: only a header (line {header_line}), no data rows. Was the log cut?"
        )
    body, commas = _with_points(path, body) if delimiter != "," else (body, [])
    lines = np.array([number for number, _ in body])
    texts = [text for _, text in body]
    try:
        values = np.loadtxt(texts, delimiter=delimiter, comments=None, ndmin=2, quotechar='"')
        whole = values.shape == (len(texts), len(names))
    except (ValueError, OverflowError):
        whole = False
    rejected: dict[str, str] = {}
    notes: list[str] = []
    if whole:
        columns = dict(zip(names, values.T, strict=True))
    else:
        columns, rejected, notes = _walk(path, names, delimiter, body)
    notes = [*commas, *notes]
    if columns.pop("", None) is not None or rejected.pop("", None) is not None:
        notes.append("A column without a name in the header was left out.")
    return Table(str(path), columns, rejected=rejected, lines=lines, notes=tuple(notes))


def _lines(path: Path) -> list[tuple[int, str]]:
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


def _header(path: Path, numbered: list[tuple[int, str]]) -> tuple[int, list[str], str, list]:
    """Find the header: the first line without ``#``, or the last comment before the numbers."""
    if not numbered:
        raise InputError(
            f"{path}: the file is empty. Expected a header such as t,q_joint1,tau_joint1."
        )
    first = next(
        (i for i, (_, line) in enumerate(numbered) if not line.startswith("#")), len(numbered)
    )
    commented = first > 0 and (first == len(numbered) or _starts_with_number(numbered[first][1]))
    at = first - 1 if commented else first
    number, line = numbered[at]
    line = line.lstrip("# ") if commented else line
    # The most frequent mark: a name may hold a comma, "position, joint 1".
    delimiter = max(";\t,", key=line.count) if re.search("[;\t,]", line) else ","
    names = [name.strip() for name in _split(path, line, delimiter, number)]
    if len(names) == 1 and len(line.split()) > 2:
        raise InputError(
            f"{path}: the header (line {number}) has no commas. Separate the columns by commas."
        )
    if _starts_with_number(line):
        raise InputError(
            f"{path}: line {number} holds numbers where the header is expected. Put the names of "
            "the columns in the first line: t,q_joint1,...,tau_joint1,..."
        )
    for name in names:
        if name and names.count(name) > 1:
            places = " and ".join(str(i + 1) for i, other in enumerate(names) if other == name)
            raise InputError(
                f"{path}: column {name} appears twice in the header (line {number}, columns "
                f"{places}). Keep one of them."
            )
    return number, names, delimiter, numbered[at + 1 :]


def _with_points(path: Path, body: list) -> tuple[list, list[str]]:
    """The lines with decimal points where they have decimal commas, and a note."""
    found = [number for number, line in body if "," in line]
    if not found or '"' in body[0][1]:
        return body, []
    mixed = next(((n, both) for n, line in body if (both := _BOTH.search(line))), None)
    if mixed:
        raise InputError(
            f"{path}: line {mixed[0]}: {mixed[1][0]!r} has a point and a comma. Write numbers without "
            "marks between thousands."
        )
    points = [(number, _COMMA.sub(r"\1.\2", line)) for number, line in body]
    return points, ["Commas in numbers were read as decimal points."]


def _starts_with_number(line: str) -> bool:
    for mark in ";\t":
        line = line.replace(mark, ",")
    try:
        float(line.split(",")[0].strip().strip('"'))
    except ValueError:
        return False
    return True


def _split(path: Path, line: str, delimiter: str, number: int) -> list[str]:
    try:
        return next(csv.reader([line], delimiter=delimiter))
    except (csv.Error, StopIteration) as error:
        raise InputError(f"{path}: line {number} is no CSV ({error}). Delete or mend it.") from None


def _walk(path: Path, names: list[str], delimiter: str, body: list) -> tuple[dict, dict, list[str]]:
    """Parse cell by cell: ragged rows are refused, columns with text set aside with the reason, and notes."""
    rows = []
    for row, (number, line) in enumerate(body, start=1):
        cells = _split(path, line, delimiter, number)
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
