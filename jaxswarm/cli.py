"""The command line: parse, call one library function, print. Results on stdout, the rest on stderr."""

import sys
from typing import Annotated

import typer

from jaxswarm import __version__, console, terminal, unheard
from jaxswarm.commands import register
from jaxswarm.work import run

app = typer.Typer(
    name="jaxswarm",
    help="Finds the physical effect a robot model lacks, adds it, and shows the error before and after.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)


def main() -> None:
    """Run the command line; bad input ends with one message and exit code 2."""
    run(_command)


def command_line() -> None:
    """The same as a process of its own, which ends at once when its work is done or a signal says so."""
    try:
        with unheard.watched():
            main()
    except SystemExit as end:
        if end.code in (terminal.INTERRUPTED, terminal.TERMINATED):
            terminal.leave(end.code)
        if end.code not in (None, 0):
            raise
    terminal.finish(0)


def _command() -> None:
    console.refuse_empty(sys.argv[1:])
    app(args=console.modes_first(sys.argv[1:]), standalone_mode=True)


def _version(asked: bool) -> None:
    if asked:
        typer.echo(f"jaxswarm {__version__}")
        raise typer.Exit()


@app.callback()
def modes(
    quiet: Annotated[
        bool, typer.Option("--quiet", help="Print nothing but errors, and the result of --json.")
    ] = False,
    plain: Annotated[
        bool, typer.Option("--plain", help="ASCII without colors, for logs and other programs.")
    ] = False,
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_version, is_eager=True, help="Print the version and end."
        ),
    ] = False,
) -> None:
    """Finds the physical effect a robot model lacks, adds it, and shows the error before and after."""
    console.set_modes(quiet, plain)


register(app)
