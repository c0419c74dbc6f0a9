"""Results that show themselves: tables for a terminal (rich) and for a notebook (HTML).

A :class:`Result` is the dictionary that a command prints as JSON, with the few tables that a person
reads, and where there is one, the object to go on with (a model, a trajectory).
"""

import html
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from jaxswarm.errors import printable


@dataclass(frozen=True)
class Table:
    """Rows of text under a title.

    Attributes:
        title: What the table shows.
        columns: Heads of the columns.
        rows: Cells, as many a row as there are columns.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def __rich__(self):
        from rich.table import Table as Grid
        from rich.text import Text

        grid = Grid(title=self.title or None, title_justify="left")
        for column in self.columns:
            grid.add_column(column, overflow="fold")
        for row in self.rows:
            grid.add_row(*(Text(printable(cell)) for cell in row))
        return grid

    def _repr_html_(self) -> str:
        def line(tag: str, cells) -> str:
            return "<tr>" + "".join(f"<{tag}>{html.escape(c)}</{tag}>" for c in cells) + "</tr>"

        body = "".join(line("td", row) for row in self.rows)
        title = f"<caption>{html.escape(self.title)}</caption>" if self.title else ""
        return (
            f"<table>{title}<thead>{line('th', self.columns)}</thead><tbody>{body}</tbody></table>"
        )


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

        return Group(*(Text(printable(line)) for line in self.lines), *self.tables)

    def __repr__(self) -> str:
        from rich.console import Console

        console = Console(width=110, color_system=None)
        with console.capture() as captured:
            console.print(self)
        return captured.get().rstrip()

    def _repr_html_(self) -> str:
        words = "".join(f"<p>{html.escape(line)}</p>" for line in self.lines)
        return words + "".join(table._repr_html_() for table in self.tables)
