"""The options of ``diagnose --fleet``: many logs of arms of one kind."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from jaxswarm.errors import InputError
from jaxswarm.work import work

if TYPE_CHECKING:
    from jaxswarm.logs import LogChoice
    from jaxswarm.tables import Result

_WRITTEN = ("fleet.parquet", "fleet.html")

Fleet = Annotated[
    str | None,
    typer.Option(help="Folder, glob or address (s3://, gs://) of logs of arms of one kind."),
]
Against = Annotated[
    str | None, typer.Option(help="fleet: tell arms that differ from their sisters.")
]
ArmPattern = Annotated[
    str | None,
    typer.Option(
        help="Regular expression with groups arm and date, searched in the path of a log."
    ),
]
# Processes of one machine; each takes half a gigabyte.
_MOST_WORKERS = 1000
Workers = Annotated[
    int | None,
    typer.Option(min=1, max=_MOST_WORKERS, help="Processes of this machine; default its cores."),
]
Scheduler = Annotated[
    str | None, typer.Option(help="Address of a Dask scheduler that exists: tcp://host:8786.")
]
Adaptive = Annotated[
    bool, typer.Option("--adaptive", help="As many workers as there is work for, up to --workers.")
]


class Asked(NamedTuple):
    """What the command line says of a fleet."""

    logs: "str | LogChoice | None"
    against: str | None
    arm_pattern: str | None
    workers: int | None
    scheduler: str | None
    adaptive: bool


def is_fleet(asked: Asked, logs: list[Path] | None, validation: list[Path] | None) -> bool:
    """Whether a fleet is meant; options that belong to the other case are refused.

    Raises:
        InputError: If logs are named both ways or not at all, or an option has nothing to act on.
    """
    given = {f"--{name.replace('_', '-')}": value for name, value in asked._asdict().items()}
    given.pop("--logs")
    if asked.logs is None:
        if not logs:
            raise InputError("no logs: name the LOG files to diagnose, or many with --fleet LOGS")
        if alone := [name for name, value in given.items() if value]:
            raise InputError(
                f"{', '.join(alone)}: belongs to --fleet LOGS; name the logs with that"
            )
        return False
    if logs or validation:
        what = "--validation" if validation else str(logs[0] if logs else "")
        raise InputError(
            f"{what}: --fleet {asked.logs} names all logs, each is diagnosed by itself"
        )
    if asked.scheduler is not None and (asked.workers or asked.adaptive):
        raise InputError("--scheduler has workers of its own: leave out --workers and --adaptive")
    return True


def run(
    asked: Asked,
    robot,
    out: Path,
    declare,
    model,
    seed,
    motion_cutoff,
    torque_cutoff,
    accept,
    budget,
) -> "Result":
    """Diagnose a fleet; the arguments are those of the command."""
    from jaxswarm.fleet.extra import require

    require()
    from jaxswarm.fleet.run import diagnose_fleet
    from jaxswarm.fleet.schedule import Cluster

    if asked.logs is None:
        raise InputError("no fleet: name its logs with --fleet LOGS")
    with work(out, (model, Path(robot)), _WRITTEN, resumable=True) as status:
        return diagnose_fleet(
            asked.logs,
            robot,
            out,
            declare=declare,
            model=model,
            against=asked.against,
            arm_pattern=asked.arm_pattern,
            cluster=Cluster(asked.workers, asked.scheduler, asked.adaptive),
            seed=seed,
            motion_cutoff=motion_cutoff,
            torque_cutoff=torque_cutoff,
            accept=accept,
            budget=budget,
            progress=status,
        )
