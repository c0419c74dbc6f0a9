"""Commands on data: ``inspect`` and ``fetch``."""

from pathlib import Path
from typing import Annotated

import typer

from jaxswarm import console
from jaxswarm.commands.logs import with_log_options
from jaxswarm.commands.options import Json, show
from jaxswarm.commands.robots import with_robot_options
from jaxswarm.runtime import start
from jaxswarm.work import work


def register(app: typer.Typer) -> None:
    """Add the commands of this group."""

    @app.command(epilog="Example: jaxswarm inspect arm.csv --robot arm.urdf --out seen")
    @with_robot_options
    @with_log_options("logs")
    def inspect(
        logs: Annotated[
            list[Path], typer.Argument(help="Logs: CSV, NPZ, Parquet, MAT, HDF5, MCAP.")
        ],
        robot: Annotated[
            str | None,
            typer.Option(
                help="Built-in name, .urdf, .sdf, .xml or .toml: what could be identified."
            ),
        ] = None,
        out: Annotated[
            Path | None, typer.Option("--out", help="Folder for inspection.json and pictures.")
        ] = None,
        json: Json = False,
    ) -> None:
        """Say what logs hold, and what could be identified from them, before anything is fitted."""
        start()
        from jaxswarm import outputs, tasks

        if out is not None:
            outputs.check_folder(out)
        more = []
        place = console.working(logs) if out is None else work(out, logs, ("inspection.json",))
        with place as status:
            result = tasks.inspect(logs, robot, progress=status)
            if out is not None:
                from jaxswarm import plots

                pictures = {name: plots.png(figure) for name, figure in result.plots().items()}
                report = {"inspection.json": outputs.to_json(result.content)}
                outputs.write_results(out, {**report, **pictures})
                more.append(f"written to {out}")
        show(result, json, *more)

    @app.command(epilog="Example: jaxswarm fetch emps --out data")
    def fetch(
        name: Annotated[str, typer.Argument(help="emps, tx40, ur10e or kr300.")],
        out: Annotated[
            Path | None, typer.Option("--out", help="Folder for the logs; default the current one.")
        ] = None,
        json: Json = False,
    ) -> None:
        """Download a public log of a measured arm, and say its licence and what to cite.

        The authors publish no checksums: the first download is trusted and its SHA-256 pinned in
        checksums.json; every later one has to be the same.
        """
        start()
        from jaxswarm.tasks.fetching import fetch as get

        with console.status() as status:
            result = get(name, out or Path("."), progress=status)
        show(result, json)
