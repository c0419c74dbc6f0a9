"""Options that several commands share, and how a result is shown."""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from jaxswarm import console as screen
from jaxswarm.errors import InputError

if TYPE_CHECKING:
    from jaxswarm.tables import Result

Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON on stdout.")]
ModelFile = Annotated[Path, typer.Argument(help="model.json of identify or diagnose.")]

EffectsFrom = Annotated[
    Path | None,
    typer.Option(
        help="Python file with laws of yours: it is run, so pass only what you have read."
    ),
]

_PIPED = 200


def show(result: "Result", json: bool, *more: str) -> None:
    """Print a result as JSON, or its sentences and tables and then ``more`` sentences."""

    def text() -> None:
        from rich.console import Console

        console = Console()
        if not console.is_terminal and "COLUMNS" not in os.environ:
            console.width = (
                _PIPED  # nobody reads a file by the width of a terminal: no broken names
            )
        console.print(result)
        for line in more:
            print(line)

    screen.show(result.content, json, text)


def numbers(text: str | None, name: str) -> list[float] | None:
    """A list of numbers such as ``100`` or ``100,80,20``.

    Raises:
        InputError: If one of them is no number.

    >>> numbers("100, 80", "--kp")
    [100.0, 80.0]
    """
    if text is None:
        return None
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise InputError(f"{name} {text}: give one number, or one a joint as 100,80,20") from None
