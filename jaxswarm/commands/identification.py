"""Models from logs: ``identify``, ``predict``, and ``excite`` for the motion that shows most."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from jaxswarm import console
from jaxswarm.commands.logs import with_log_options
from jaxswarm.commands.options import (
    MOST,
    Accept,
    EffectsFrom,
    Json,
    Logs,
    MotionCutoff,
    Out,
    Seed,
    TorqueCutoff,
    Validation,
)
from jaxswarm.commands.robots import RobotName, with_robot_options
from jaxswarm.errors import printable
from jaxswarm.runtime import start
from jaxswarm.work import work

# What the commands write into their folder, and would overwrite there.
_IDENTIFIED = ("model.json", "identification.json")
_EXCITED = ("trajectory.csv", "trajectory.yaml", "excitation.json")


def register(app: typer.Typer) -> None:
    """Add the commands of this group."""

    @app.command(
        epilog="Example: jaxswarm identify arm.csv --robot arm.urdf --effects viscous_friction --out out"
    )
    @with_robot_options
    @with_log_options("logs", "validation")
    def identify(
        logs: Logs,
        robot: RobotName,
        effects: Annotated[str, typer.Option(help="none, or name@joint, ...: without joint, all.")],
        out: Out,
        validation: Validation = None,
        optimizer: Annotated[str, typer.Option(help="least_squares or a swarm.")] = "least_squares",
        runs: Annotated[int, typer.Option(min=1, max=MOST, help="Runs of the swarm.")] = 10,
        steps: Annotated[int, typer.Option(min=1, max=MOST, help="Steps of the swarm.")] = 500,
        whiten: Annotated[
            bool,
            typer.Option("--whiten/--raw", help="Swarm: coordinates whitened by R, or parameters."),
        ] = True,
        seed: Seed = 0,
        motion_cutoff: MotionCutoff = None,
        torque_cutoff: TorqueCutoff = None,
        free_base: Annotated[
            bool,
            typer.Option("--free-base", help="The base may stand tilted: fit gravity's direction."),
        ] = False,
        estimator: Annotated[
            str, typer.Option(help="least_squares, instrumental (needs q_ref) or output_error.")
        ] = "least_squares",
        physical: Annotated[
            bool, typer.Option("--physical", help="Rigid bodies for links: the nearest ones.")
        ] = False,
        prior: Annotated[
            str | None, typer.Option(help="Robot whose bodies to stay near: name, .urdf or .toml.")
        ] = None,
        prior_weight: Annotated[
            float,
            typer.Option(min=1e-9, help="Residual standard deviations a mass off by e^2 costs."),
        ] = 0.03,
        accept: Accept = None,
        effects_from: EffectsFrom = None,
        json: Json = False,
    ) -> None:
        """Identify a declared model from logs and score it on motion it was not fitted to."""
        start()
        from jaxswarm.diagnose.selection.what_moves import fit_of_what_moves
        from jaxswarm.effects import register_from
        from jaxswarm.effects.bodies import with_free_base
        from jaxswarm.identify import print_identification
        from jaxswarm.identify.run import Options, identify_files

        effects = with_free_base(effects) if free_base else effects
        options = Options(
            optimizer, runs, steps, whiten, seed, motion_cutoff, torque_cutoff,
            estimator, physical, prior, prior_weight, tuple(accept or ()),
        )  # fmt: skip
        inputs = (*logs, validation, Path(prior) if prior else None, Path(robot), effects_from)
        with work(out, inputs, _IDENTIFIED) as status:
            if effects_from:
                register_from(effects_from)
            fit = partial(fit_of_what_moves, seed=seed)
            report = identify_files(logs, robot, effects, out, validation, options, status, fit)
        console.notes([*report["logs"], *report["validation_logs"]])
        console.show(
            report, json, lambda: print_identification(console.safe(report), console.safe(out))
        )

    @app.command(epilog="Example: jaxswarm predict out/model.json other.csv --out torque.csv")
    @with_log_options("log")
    def predict(
        model: Annotated[Path, typer.Argument(help="model.json of identify or diagnose.")],
        log: Annotated[Path, typer.Argument(help="Log of the motion; torque is not needed.")],
        out: Annotated[Path, typer.Option("--out", help="CSV file to write.")],
        effects_from: EffectsFrom = None,
        json: Json = False,
    ) -> None:
        """Predict the torque of an identified model along a log, at its own time stamps."""
        start()
        from jaxswarm.effects import register_from
        from jaxswarm.identify.predict import predict_file

        with work(out, (model, log, effects_from)):
            if effects_from:
                register_from(effects_from)
            result = predict_file(model, log, out)
        console.notes([{"source": result["log"], "notes": result["notes"]}])
        text = f"{result['samples']} samples written to {printable(result['out'])}"
        console.show(result, json, lambda: print(text))

    @app.command(epilog="Example: jaxswarm excite --robot rx60 --limits limits.toml --out plan")
    @with_robot_options
    def excite(
        robot: RobotName,
        limits: Annotated[Path, typer.Option(help="TOML file: what every joint may do.")],
        out: Out,
        effects: Annotated[
            str | None,
            typer.Option(
                help="What will be identified: none, or name, name@joint, with commas between; default: "
                "viscous and dry friction of every joint."
            ),
        ] = None,
        duration: Annotated[
            float | None, typer.Option(min=0.1, help="Length in seconds; default one period.")
        ] = None,
        separate: Annotated[
            str | None,
            typer.Option(help="Two effects to tell apart: effect@joint,effect@joint."),
        ] = None,
        given: Annotated[
            Path | None,
            typer.Option(
                help="model.json: its masses and effects say what torque a motion needs; --separate takes "
                "them for granted."
            ),
        ] = None,
        seed: Seed = 0,
        json: Json = False,
    ) -> None:
        """Plan a motion within limits on which the parameters, or two effects, can be told apart best."""
        start()
        from jaxswarm.identify.excite_run import excite_file, print_excitation

        inputs = (limits, Path(robot), *([] if given is None else [given]))
        with work(out, inputs, _EXCITED) as status:
            result = excite_file(
                robot, limits, out, effects, duration, seed, status, separate, given
            )
        console.show(
            result, json, lambda: print_excitation(console.safe(result), console.safe(out))
        )
