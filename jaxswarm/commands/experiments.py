"""The experiments of two papers: ``study``."""

from typing import Annotated

import typer

from jaxswarm import console
from jaxswarm.commands.options import Json, Out, Seed
from jaxswarm.errors import InputError, printable
from jaxswarm.runtime import start
from jaxswarm.work import work


def register(app: typer.Typer) -> None:
    """Add the commands of this group."""

    @app.command(epilog="Example: jaxswarm study rx60 --out rx60 --fast")
    def study(
        name: Annotated[str, typer.Argument(help="rx60 or sepso.")],
        out: Out,
        fast: Annotated[
            bool, typer.Option("--fast", help="Fewer runs: a minute, not minutes.")
        ] = False,
        seed: Seed = 0,
        json: Json = False,
    ) -> None:
        """Run the experiments of one of the two papers and write the report."""
        start()
        from jaxswarm.errors import nearest
        from jaxswarm.outputs import check_folder
        from jaxswarm.studies import STUDIES

        if name not in STUDIES:
            raise InputError(f"unknown study {name!r}. {nearest(name, STUDIES)}")
        check_folder(out)
        with work(out, (), ("report.html",)) as status:
            result = STUDIES[name](out, fast=fast, seed=seed, progress=status)
        console.show(result, json, lambda: print(printable(f"report: {out / 'report.html'}")))
