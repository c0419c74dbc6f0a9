"""The command ``doctor``: what a bug report needs."""

import typer

from jaxswarm import console
from jaxswarm.commands.options import Json, show
from jaxswarm.runtime import start


def register(app: typer.Typer) -> None:
    """Add the command."""

    @app.command(epilog="Example: jaxswarm doctor --json > doctor.json")
    def doctor(json: Json = False) -> None:
        """Check the installation: versions, devices, cache, threads, a small identification.

        Exit code 1 if the identification does not give the known numbers.
        """
        start()
        from jaxswarm.tasks.health import doctor as examine

        with console.status() as status:
            result = examine(progress=status)
        show(result, json)
        if not result["healthy"]:
            raise typer.Exit(1)
