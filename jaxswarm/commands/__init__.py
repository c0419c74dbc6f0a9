"""Commands in groups, one file each; what a command needs is imported when it runs, so help is quick."""

import typer

from jaxswarm.commands import (
    data,
    experiments,
    identification,
    lists,
    loop,
    models,
    robots,
    system,
)


def register(app: typer.Typer) -> None:
    """Add the commands, in the order in which help lists them."""
    for group in (loop, identification, models, data, experiments, lists, robots, system):
        group.register(app)
