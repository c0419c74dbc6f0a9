"""Commands in groups, one file each; what a command needs is imported when it runs, so help is quick."""

from collections.abc import Callable

import typer

from jaxswarm.commands import data, models, system


def register(app: typer.Typer, start: Callable[[], None]) -> None:
    """Add the commands.

    Args:
        app: The command line.
        start: Called at the beginning of each command: precision, threads, cache.
    """
    for group in (models, data, system):
        group.register(app, start)
