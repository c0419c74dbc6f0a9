"""What a command says: stage and time on stderr while it works, text, tables or JSON on stdout at the end."""

import codecs
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

MODES = ("--quiet", "--plain")
_QUIET: ContextVar[bool] = ContextVar("quiet", default=False)
_ASCII = {"±": "+-", "²": "^2", "³": "^3", "°": " deg", "·": "*", "…": "...", "–": "-"}


def modes_first(words: list[str]) -> list[str]:
    """The words of a command line with ``--quiet`` and ``--plain`` in front, wherever they stood.

    >>> modes_first(["compare", "a", "--quiet", "b"])
    ['--quiet', 'compare', 'a', 'b']
    """
    return [w for w in words if w in MODES] + [w for w in words if w not in MODES]


def set_modes(quiet: bool, plain: bool) -> None:
    """How this command speaks: ``quiet`` says nothing but JSON and errors, ``plain`` is ASCII alone."""
    _QUIET.set(quiet)
    if plain:
        os.environ |= {"NO_COLOR": "1", "TERM": "dumb"}
        os.environ.pop("FORCE_COLOR", None)
        codecs.register_error("jaxswarm_plain", _in_ascii)
        for stream in (sys.stdout, sys.stderr):
            if hasattr(stream, "reconfigure"):  # tests and notebooks have streams of their own
                stream.reconfigure(encoding="ascii", errors="jaxswarm_plain")


def _in_ascii(error: UnicodeError) -> tuple[str, int]:
    """What stands for characters that ASCII lacks."""
    text = error.object[error.start : error.end]
    return "".join(_ASCII.get(c, "?") for c in text), error.end


@contextmanager
def status() -> Iterator[Callable[[str], None]]:
    """The stage and the time since the start on stderr; nothing where stderr is no terminal."""
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = SpinnerColumn(), TimeElapsedColumn(), TextColumn("{task.description}")
    console = Console(stderr=True)
    # A disabled display prints nothing at all; a live one ends with an empty line even in a file.
    hidden = not console.is_terminal or _QUIET.get()
    with Progress(*columns, console=console, transient=True, disable=hidden) as progress:
        task = progress.add_task("starting", total=None)
        yield lambda text: progress.update(task, description=text)


def show(result: Any, json: bool, text: Callable[[], None]) -> None:
    """Print a result as JSON, or what ``text`` prints."""
    if json:
        from jaxswarm.outputs import to_json

        sys.stdout.write(to_json(result))
    elif not _QUIET.get():
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
