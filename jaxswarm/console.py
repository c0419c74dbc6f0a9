"""What a command says: stage and time on stderr while it works, text, tables or JSON on stdout at the end."""

import codecs
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

from jaxswarm.errors import InputError, printable

MODES = ("--quiet", "--plain")
_QUIET: ContextVar[bool] = ContextVar("quiet", default=False)
_ASCII = {"±": "+-", "²": "^2", "³": "^3", "°": " deg", "·": "*", "…": "...", "–": "-"}


def modes_first(words: list[str]) -> list[str]:
    """The words of a command line with ``--quiet`` and ``--plain`` in front, wherever they stood.

    >>> modes_first(["compare", "a", "--quiet", "b"])
    ['--quiet', 'compare', 'a', 'b']
    """
    return [w for w in words if w in MODES] + [w for w in words if w not in MODES]


def refuse_empty(words: Sequence[str]) -> None:
    """Refuse words of a command line without a character: a path without one would be the folder one is in.

    Raises:
        InputError: Naming the option, or the word before.

    >>> refuse_empty(["identify", "a.csv", "--out", ""])
    Traceback (most recent call last):
        ...
    jaxswarm.errors.InputError: --out '': an empty word; give a value there, or leave it away
    """
    for before, word in zip(["jaxswarm", *words], words, strict=False):
        joined = word.startswith("--")
        name, equals, value = word.partition("=") if joined else (before, "=", word)
        if equals and not value.strip():
            raise InputError(
                f"{name} {value!r}: an empty word; give a value there, or leave it away"
            )


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
    if not isinstance(error, UnicodeEncodeError):
        raise error
    text = error.object[error.start : error.end]
    return "".join(_ASCII.get(c, "?") for c in text), error.end


@contextmanager
def status() -> Iterator[Callable[[str], None]]:
    """The stage and the time since the start on stderr; nothing where stderr is no terminal."""
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    # The usual spinner is drawn in Braille, which not every terminal can show.
    spinner = SpinnerColumn("line" if console.options.ascii_only else "dots")
    columns = spinner, TimeElapsedColumn(), TextColumn("{task.description}", markup=False)
    # A disabled display prints nothing at all; a live one ends with an empty line even in a file.
    hidden = not console.is_terminal or _QUIET.get()
    with Progress(*columns, console=console, transient=True, disable=hidden) as progress:
        task = progress.add_task("starting", total=None)
        yield lambda text: progress.update(task, description=printable(text))


@contextmanager
def working(inputs: Sequence[Path]) -> Iterator[Callable[[str], None]]:
    """Show the stage of the work, and turn a numerical failure in it into a message.

    Args:
        inputs: What the work is about, named in the message.

    Raises:
        InputError: Naming inputs and stage, where the numbers of the inputs led to a singular matrix, a
            division by zero, an overflow, or to more than the memory holds. Anything else is a
            mistake of ours and stays what it is.
    """
    import numpy as np

    stage = "starting"

    def progress(text: str) -> None:
        nonlocal stage
        stage = text
        tell(text)

    named = ", ".join(map(str, inputs)) or "a log made by this command"
    try:
        with status() as tell:
            yield progress
    except MemoryError as error:
        raise InputError(
            f"{named}: not enough memory while {stage} ({error}); use shorter logs or a lower rate"
        ) from error
    except (np.linalg.LinAlgError, ArithmeticError) as error:
        raise InputError(
            f"{named}: the numbers failed while {stage} ({type(error).__name__}: {error}). Look at the "
            "log for values that cannot be, declare fewer effects, or log more motion"
        ) from error


def show(result: Any, json: bool, text: Callable[[], None]) -> None:
    """Print a result as JSON, or what ``text`` prints."""
    if json:
        from jaxswarm.outputs import to_json

        sys.stdout.write(to_json(result))
    elif not _QUIET.get():
        text()


def safe(content: Any) -> Any:
    """The same nested dicts and lists with every text fit for rich: no markup, no control characters.

    >>> safe({"a[/b]": ["x\\x1b"]})
    {'a\\\\[/b]': ['x\\\\x1b']}
    """
    from rich.markup import escape

    if isinstance(content, dict):
        return {safe(key): safe(value) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return type(content)(safe(value) for value in content)
    if isinstance(content, Path):
        return Path(safe(str(content)))
    return escape(printable(content)) if isinstance(content, str) else content


def notes(logs: Sequence[dict]) -> None:
    """Print on stderr what was found in logs while they were read."""
    for log in logs:
        for text in log.get("notes", ()):
            note(f"{log['source']}: {text}")


def note(text: str) -> None:
    """Print on stderr what a user should know, unless nothing but errors is asked for."""
    if not _QUIET.get():
        print(f"note: {printable(text)}", file=sys.stderr)


def table(rows: list[dict], json: bool, columns: tuple[str, ...]) -> None:
    """Print rows as JSON or as a table of some of their columns."""

    def text() -> None:
        from rich.console import Console
        from rich.table import Table

        grid = Table(*columns)
        for row in safe(rows):
            cells = (row[c] for c in columns)
            grid.add_row(*(", ".join(c) if isinstance(c, list) else str(c) for c in cells))
        Console().print(grid)

    show(rows, json, text)
