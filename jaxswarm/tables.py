"""Results that show themselves: tables for a terminal (rich) and for a notebook (HTML).

A :class:`Result` is the dictionary that a command prints as JSON, with the few tables that a person
reads, and where there is one, the object to go on with (a model, a trajectory).
"""

import html
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from jaxswarm.errors import printable

# A column of numbers is never broken; one with cells longer than this holds sentences that begin with one.
_LONGEST_NUMBER = 30
# What a column of words, or the head of a column, gets at least where its longest word is longer.
_WORD = 14
# A first column says what its row is about: a name in it stands whole up to this length, that of an effect on
# a joint with a long name of its own.
_LABEL = 36
_GAP = 2


@dataclass(frozen=True)
class Table:
    """Rows of text under a title.

    On a terminal words fold where they have to and numbers never do: columns that do not fit beside each
    other follow below, beside the first one again.

    Attributes:
        title: What the table shows.
        columns: Heads of the columns.
        rows: Cells, as many a row as there are columns.
        marked: Indices of rows that deserve a second look.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    marked: frozenset[int] = frozenset()

    def __rich_console__(self, console, options):
        title = self.title
        for part in self._side_by_side(options.max_width):
            whole = [max(map(len, [*self._cells(k), self.columns[k]])) for k in part]
            roomy = sum(whole) + _GAP * (len(part) - 1) <= options.max_width
            yield self._grid(title, part, roomy)
            title = ""

    def _cells(self, k: int) -> list[str]:
        return [printable(row[k]) for row in self.rows]

    def _least_width(self, k: int) -> int:
        """What a column needs, so that no number in it is broken."""
        cells = self._cells(k)
        if _of_numbers(cells):
            lines = [*cells, *_folded_head(printable(self.columns[k]), cells).splitlines()]
            return max(map(len, lines))
        words = " ".join([*cells, self.columns[k]]).split()
        return min(_WORD if k else _LABEL, max(map(len, words), default=0))

    def _side_by_side(self, width: int) -> Iterator[list[int]]:
        """Indices of columns that fit beside the first one, group by group."""
        part, used = [0], self._least_width(0)
        for k in range(1, len(self.columns)):
            needed = _GAP + self._least_width(k)
            if used + needed > width and len(part) > 1:
                yield part
                part, used = [0], self._least_width(0)
            part.append(k)
            used += needed
        yield part

    def _grid(self, title: str, part: Sequence[int], roomy: bool):
        from rich import box
        from rich.table import Table as Grid
        from rich.text import Text

        grid = Grid(
            title=Text(printable(title)) if title else None,
            title_justify="left",
            title_style="bold",
            box=box.SIMPLE,
            padding=(0, 1),
            collapse_padding=True,
            pad_edge=False,
            show_edge=False,
        )
        for k in part:
            cells = self._cells(k)
            if _of_numbers(cells):
                head = printable(self.columns[k])
                head = head if roomy else _folded_head(head, cells)
                grid.add_column(Text(head), no_wrap=True, justify="right")
            else:
                grid.add_column(Text(printable(self.columns[k])), overflow="fold")
        for number, row in enumerate(self.rows):
            style = "bold" if number in self.marked else None
            grid.add_row(*(Text(printable(row[k])) for k in part), style=style)
        return grid

    def _repr_html_(self) -> str:
        def line(tag: str, cells) -> str:
            return "<tr>" + "".join(f"<{tag}>{html.escape(c)}</{tag}>" for c in cells) + "</tr>"

        body = "".join(line("td", row) for row in self.rows)
        title = f"<caption>{html.escape(self.title)}</caption>" if self.title else ""
        return (
            f"<table>{title}<thead>{line('th', self.columns)}</thead><tbody>{body}</tbody></table>"
        )


def _of_numbers(cells: Sequence[str]) -> bool:
    return (
        any(re.match(r"-?\d", cell) for cell in cells) and max(map(len, cells)) <= _LONGEST_NUMBER
    )


def _folded_head(head: str, cells: Sequence[str]) -> str:
    """The head of a column of numbers, hardly wider than they are."""
    word = min(_WORD, max(map(len, head.split()), default=1))
    width = max(word, *map(len, cells))
    return "\n".join(textwrap.wrap(head, width))


@dataclass(frozen=True, eq=False, repr=False)
class Result(Mapping):
    """What a task found: reads as the dictionary of its JSON, shows as sentences and tables.

    Attributes:
        content: The dictionary, plain data.
        lines: Sentences, the most important first.
        tables: What a person reads.
    """

    content: dict[str, Any]
    lines: tuple[str, ...] = ()
    tables: tuple[Table, ...] = field(default=())

    def __getitem__(self, key: str) -> Any:
        return self.content[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self.content)

    def __len__(self) -> int:
        return len(self.content)

    def __rich__(self):
        from rich.console import Group
        from rich.text import Text

        spaced = (part for table in self.tables for part in (Text(), table))
        return Group(*(Text(printable(line)) for line in self.lines), *spaced)

    def __repr__(self) -> str:
        from rich.console import Console

        console = Console(width=110, color_system=None)
        with console.capture() as captured:
            console.print(self)
        return captured.get().rstrip()

    def _repr_html_(self) -> str:
        words = "".join(f"<p>{html.escape(line)}</p>" for line in self.lines)
        return words + "".join(table._repr_html_() for table in self.tables)
