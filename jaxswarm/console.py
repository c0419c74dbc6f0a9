"""What a command says: stage and time on stderr while it works, text, tables or JSON on stdout at the end."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def status() -> Iterator[Callable[[str], None]]:
    """The stage and the time since the start on stderr; nothing where stderr is no terminal."""
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = SpinnerColumn(), TimeElapsedColumn(), TextColumn("{task.description}")
    console = Console(stderr=True)
    # A disabled display prints nothing at all; a live one ends with an empty line even in a file.
    hidden = not console.is_terminal
    with Progress(*columns, console=console, transient=True, disable=hidden) as progress:
        task = progress.add_task("starting", total=None)
        yield lambda text: progress.update(task, description=text)


def show(result: Any, json: bool, text: Callable[[], None]) -> None:
    """Print a result as JSON, or what ``text`` prints."""
    if json:
        from jaxswarm.outputs import to_json

        sys.stdout.write(to_json(result))
    else:
        text()


def table(rows: list[dict], json: bool, columns: tuple[str, ...]) -> None:
    """Print rows as JSON or as a table of some of their columns."""

    def text() -> None:
        from rich.console import Console
        from rich.table import Table

        grid = Table(*columns)
        for row in rows:
            cells = (row[c] for c in columns)
            grid.add_row(*(", ".join(c) if isinstance(c, list) else str(c) for c in cells))
        Console().print(grid)

    show(rows, json, text)
