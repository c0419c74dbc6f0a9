"""Options that several commands share, and how a result is shown."""

import inspect
import os
import shlex
import sys
from collections.abc import Callable, Mapping
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from jaxswarm import console as screen
from jaxswarm.errors import InputError

if TYPE_CHECKING:
    from jaxswarm.tables import Result

Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON on stdout.")]
_LOGS = typer.Argument(help="Logs to fit: CSV, NPZ, Parquet, MAT, HDF5, MCAP.")
Logs = Annotated[list[Path], _LOGS]
LogsOrNone = Annotated[list[Path] | None, _LOGS]
Out = Annotated[Path, typer.Option("--out", help="Folder for the results.")]
Validation = Annotated[Path | None, typer.Option("--validation", help="Log to score on.")]
# Seeds are 64-bit integers with a sign wherever random numbers are made.
LARGEST_SEED = 2**63 - 1
# Runs and steps are counted in 32 bits on devices.
MOST = 2**31 - 1
Seed = Annotated[
    int, typer.Option(min=0, max=LARGEST_SEED, help="Draws whatever is drawn; repeats exactly.")
]


def finite(number: float | None) -> float | None:
    """The number, which has to be one."""
    if number is not None and not isfinite(number):
        raise typer.BadParameter(f"{number} is no finite number.")
    return number


MotionCutoff = Annotated[
    float | None,
    typer.Option(
        min=0.01, callback=finite, help="Low-pass of the motion [Hz]; found from the data."
    ),
]
TorqueCutoff = Annotated[
    float | None,
    typer.Option(min=0.01, callback=finite, help="Low-pass shared by torque and model [Hz]."),
]


Accept = Annotated[
    list[str] | None,
    typer.Option(help="Fit a log in spite of this finding about it; may be repeated."),
]

ModelFile = Annotated[Path, typer.Argument(help="model.json of identify or diagnose.")]

EffectsFrom = Annotated[
    Path | None,
    typer.Option(
        help="Python file with laws of yours: it is run, so pass only what you have read."
    ),
]

_PIPED = 200


def words_of_command() -> str:
    """The words this command was called with, files by their names; not those about where it prints."""
    kept, words = ["jaxswarm"], iter(sys.argv[1:])
    for word in words:
        if word == "--out":
            next(words, None)
        elif word not in (*screen.MODES, "--json") and not word.startswith("--out="):
            kept.append(Path(word).name if os.path.exists(word) else word)
    return shlex.join(kept)


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


def widened(
    run: Callable[..., Any], command: Callable[..., Any], options: Mapping[str, Any]
) -> Any:
    """``run`` with the parameters of ``command``, by keyword, and the options behind them, none given."""
    signature = inspect.signature(command)
    kind = inspect.Parameter.KEYWORD_ONLY
    added = [
        inspect.Parameter(name, kind, default=None, annotation=option)
        for name, option in options.items()
    ]
    own = [p.replace(kind=kind) for p in signature.parameters.values()]
    run.__signature__ = signature.replace(parameters=[*own, *added])  # type: ignore[attr-defined]
    return run
