"""Lines of a CSV file: which one is the header, what parts the cells, and what a comma in a number is."""

import csv
import re
from pathlib import Path

from jaxswarm.errors import InputError

# Numbers of lines from 1, with the lines.
Numbered = list[tuple[int, str]]
# A decimal comma between digits; a number with a point and a comma.
_COMMA = re.compile(r"(?<![\d,])([+-]?\d*),(\d+)(?![\d,])")
_BOTH = re.compile(r"\d[\d]*(?:\.\d+,|,\d+\.)\d+")


def header_of(path: Path, numbered: Numbered) -> tuple[int, list[str], str, Numbered]:
    """Find the header: the first line without ``#``, or the last comment before the numbers."""
    if not numbered:
        raise InputError(
            f"{path}: the file is empty. Expected a header such as t,q_joint1,tau_joint1."
        )
    first = next(
        (i for i, (_, line) in enumerate(numbered) if not line.startswith("#")), len(numbered)
    )
    commented = first > 0 and (first == len(numbered) or starts_with_number(numbered[first][1]))
    at = first - 1 if commented else first
    number, line = numbered[at]
    line = line.lstrip("# ") if commented else line
    # The most frequent mark: a name may hold a comma, "position, joint 1".
    delimiter = max(";\t,", key=line.count) if re.search("[;\t,]", line) else ","
    names = [name.strip() for name in split(path, line, delimiter, number)]
    if len(names) == 1 and len(line.split()) > 2:
        raise InputError(
            f"{path}: the header (line {number}) has no commas. Separate the columns by commas."
        )
    if starts_with_number(line):
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


def with_points(path: Path, body: Numbered) -> tuple[Numbered, list[str]]:
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


def split(path: Path, line: str, delimiter: str, number: int) -> list[str]:
    """The cells of a line."""
    try:
        return next(csv.reader([line], delimiter=delimiter))
    except (csv.Error, StopIteration) as error:
        raise InputError(f"{path}: line {number} is no CSV ({error}). Delete or mend it.") from None


def starts_with_number(line: str) -> bool:
    """Whether the first cell of a line is a number."""
    for mark in ";\t":
        line = line.replace(mark, ",")
    try:
        float(line.split(",")[0].strip().strip('"'))
    except ValueError:
        return False
    return True
