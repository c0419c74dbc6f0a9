"""The loop: ``demo`` and ``diagnose``."""

from pathlib import Path
from typing import Annotated

import typer

from jaxswarm import console
from jaxswarm.commands import fleets
from jaxswarm.commands.logs import with_log_options
from jaxswarm.commands.options import (
    LARGEST_SEED,
    Accept,
    EffectsFrom,
    Json,
    LogsOrNone,
    MotionCutoff,
    Out,
    Seed,
    TorqueCutoff,
    finite,
    show,
    words_of_command,
)
from jaxswarm.commands.robots import RobotName, with_robot_options
from jaxswarm.errors import InputError
from jaxswarm.runtime import start
from jaxswarm.work import work

# What the commands write into their folder, and would overwrite there.
_DIAGNOSED = ("model.json", "diagnosis.json", "report.html")

Declare = Annotated[
    str | None,
    typer.Option(
        help="What is known to be there: none, or name, name@joint, name@joint:partner, with commas between."
    ),
]
Earlier = Annotated[
    Path | None, typer.Option(help="model.json identified before: find what changed since.")
]
Validations = Annotated[list[Path] | None, typer.Option(help="Log to score on; may be repeated.")]
Seconds = Annotated[
    float | None,
    typer.Option(
        min=1e-3,
        callback=finite,
        help="Seconds after which no further round begins: what is known then is reported.",
    ),
]
Discover = Annotated[
    bool, typer.Option("--discover", help="Search a formula for what no known law explains.")
]


def register(app: typer.Typer) -> None:
    """Add the commands of this group."""

    @app.command(epilog="Example: jaxswarm demo --seed 3")
    def demo(
        seed: Annotated[
            int,
            typer.Option(min=0, max=LARGEST_SEED, help="Draws the arm, its motion and the effect."),
        ] = 0,
        out: Annotated[Path, typer.Option("--out", help="Folder for the report.")] = Path(
            "out/demo"
        ),
        json: Json = False,
    ) -> None:
        """Make an RX60 log with an undeclared effect, find it, and only then show the truth."""
        start(queue=False)
        from jaxswarm.diagnose import print_diagnosis
        from jaxswarm.diagnose.demo import run_demo
        from jaxswarm.diagnose.report.text import where

        with work(out, (), _DIAGNOSED) as status:
            result, truth = run_demo(seed, out, status)

        def text() -> None:
            print_diagnosis(console.safe(result), console.safe(out))
            values = ", ".join(f"{k} = {v:.5g}" for k, v in truth["values"].items())
            print(f"the truth: {where(truth)} ({values})")

        console.show({**result, "truth": truth}, json, text)

    @app.command(
        epilog="Example: jaxswarm diagnose arm.csv --robot arm.urdf --declare viscous_friction --out found"
    )
    @with_robot_options
    @with_log_options("logs", "validation", "fleet")
    def diagnose(
        robot: RobotName,
        out: Out,
        logs: LogsOrNone = None,
        declare: Declare = None,
        model: Earlier = None,
        validation: Validations = None,
        seed: Seed = 0,
        motion_cutoff: MotionCutoff = None,
        torque_cutoff: TorqueCutoff = None,
        accept: Accept = None,
        budget: Seconds = None,
        discover: Discover = False,
        effects_from: EffectsFrom = None,
        fleet: fleets.Fleet = None,
        against: fleets.Against = None,
        arm_pattern: fleets.ArmPattern = None,
        workers: fleets.Workers = None,
        scheduler: fleets.Scheduler = None,
        adaptive: fleets.Adaptive = False,
        json: Json = False,
    ) -> None:
        """Find the effect a declared model lacks, add it, and show the error before and after."""
        start(queue=False)
        asked = fleets.Asked(fleet, against, arm_pattern, workers, scheduler, adaptive)
        _check_question(declare, model, discover)
        if fleets.is_fleet(asked, logs, validation):
            if discover or effects_from:
                raise InputError(
                    "--fleet takes neither --discover nor --effects-from; diagnose one log"
                )
            cutoffs = motion_cutoff, torque_cutoff
            question = (declare, model, seed, *cutoffs, tuple(accept or ()), budget)
            show(fleets.run(asked, robot, out, *question), json)
            return
        from jaxswarm.diagnose import print_diagnosis
        from jaxswarm.diagnose.run import diagnose_files
        from jaxswarm.effects import register_from
        from jaxswarm.identify.run import Options

        options = Options(
            seed=seed, motion_cutoff=motion_cutoff, torque_cutoff=torque_cutoff,
            accept=tuple(accept or ()), budget=budget, discover=discover,
            command=words_of_command(),
        )  # fmt: skip
        given = logs or []  # without logs and without a fleet there is a message before
        inputs = (*given, *(validation or ()), model, Path(robot), effects_from)
        with work(out, inputs, _DIAGNOSED, resumable=True) as status:
            if effects_from:
                register_from(effects_from)
            if model is not None:
                from jaxswarm.diagnose.run_against import compare_files

                result = compare_files(given, robot, model, out, validation, options, status)
            else:
                declare = declare or "none"
                result = diagnose_files(given, robot, declare, out, validation, options, status)
        console.notes([*result["logs"], *result.get("validation_logs", ())])
        console.show(result, json, lambda: print_diagnosis(console.safe(result), console.safe(out)))


def _check_question(declare: str | None, model: Path | None, discover: bool) -> None:
    """Refuse what an earlier model excludes."""
    if model is not None and declare is not None:
        raise InputError("--declare and --model exclude each other; a model holds what is declared")
    if model is not None and discover:
        raise InputError("--discover goes with --declare: against a model nothing is searched")
