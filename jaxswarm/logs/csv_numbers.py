"""A CSV file that holds numbers alone, read in pieces: its text never stands in memory as a whole."""

from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import TextIO

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.logs.bounds import refuse_large
from jaxswarm.logs.csv_lines import Numbered, header_of, with_points
from jaxswarm.logs.table import Table

# Lines that are parsed at a time, and letters of a line beyond which it is none of a log.
_LINES, _LONGEST = 20_000, 2**20
# Bytes that are looked at together for the ends of lines.
_PIECE = 2**24
_NUMBER = 8


class _NoNumbers(Exception):
    """Something else than numbers stands in the file, or no text at all."""


def of_numbers(path: Path) -> Table | None:
    """The table of a file with a header and, in every further line that is not blank, as many numbers.

    None for any other file: what is wrong with it, or what else it holds, is told where all of it is at hand.

    Raises:
        InputError: If there are too many numbers, or the header cannot be used.
    """
    with path.open(encoding="utf-8-sig", newline=None) as file:
        try:
            return _read(path, file)
        except InputError:
            raise
        except (_NoNumbers, UnicodeDecodeError, ValueError, OverflowError):
            return None


def _read(path: Path, file: TextIO) -> Table:
    numbered = _numbered(file)
    header, names, delimiter, first = header_of(path, _head(numbered))
    most = _line_ends(path) + 1
    refuse_large(path, _NUMBER * most * len(names))
    # Memory that nothing is written to is none, so that a few rows too many cost nothing.
    values, lines = np.empty((len(names), most)), np.empty(most, dtype=int)
    rows = 0
    notes: list[str] = []
    while body := [*first, *islice(numbered, _LINES)]:
        first = []
        if delimiter != ",":
            body, commas = with_points(path, body)
            notes = commas or notes
        texts = [text for _, text in body]
        part = np.loadtxt(texts, delimiter=delimiter, comments=None, ndmin=2, quotechar='"')
        if part.shape != (len(texts), len(names)):
            raise _NoNumbers
        values[:, rows : rows + len(part)] = part.T
        lines[rows : rows + len(part)] = [number for number, _ in body]
        rows += len(part)
    if not rows:
        raise _NoNumbers
    columns = dict(zip(names, values[:, :rows], strict=True))
    return Table(str(path), columns, lines=lines[:rows], notes=tuple(notes))


def _numbered(file: TextIO) -> Iterator[tuple[int, str]]:
    """Lines that are not blank, with their numbers from 1."""
    number = 0
    while line := file.readline(_LONGEST):
        number += 1
        if len(line) == _LONGEST or "\x00" in line:
            raise _NoNumbers
        if line.strip():
            yield number, line.removesuffix("\n")


def _head(numbered: Iterator[tuple[int, str]]) -> Numbered:
    """The lines up to the first one that is no comment."""
    head = []
    for number, line in numbered:
        head.append((number, line))
        if not line.startswith("#"):
            break
    return head


def _line_ends(path: Path) -> int:
    """How many lines end in a file, at most."""
    fed = returned = 0
    with path.open("rb") as file:
        while piece := file.read(_PIECE):
            fed += piece.count(b"\n")
            returned += piece.count(b"\r")
    return max(fed, returned) if min(fed, returned) in (0, max(fed, returned)) else fed + returned
