"""Commands on identified models: ``export``, ``simulate``, ``compare``."""

from pathlib import Path
from typing import Annotated

import typer

from jaxswarm.commands.logs import with_log_options
from jaxswarm.commands.options import EffectsFrom, Json, ModelFile, numbers, show
from jaxswarm.errors import InputError
from jaxswarm.runtime import start
from jaxswarm.work import work


def register(app: typer.Typer) -> None:
    """Add the commands of this group."""

    @app.command(epilog="Example: jaxswarm export out/model.json --format urdf --out arm.urdf")
    @with_log_options("log")
    def export(
        model: ModelFile,
        out: Annotated[Path, typer.Option("--out", help="File to write.")],
        format: Annotated[
            str | None,
            typer.Option(
                help="urdf, mjcf, sdf (Gazebo, Drake), yaml (Pinocchio) or c; default by the ending."
            ),
        ] = None,
        log: Annotated[
            Path | None, typer.Option(help="Motion on which the torque has to stay as it is.")
        ] = None,
        prior: Annotated[
            str | None, typer.Option(help="Robot whose bodies to stay near: name, .urdf or .toml.")
        ] = None,
        prior_weight: Annotated[
            float | None,
            typer.Option(
                help="Residual standard deviations a mass off by e^2 costs (default 0.03)."
            ),
        ] = None,
        effects_from: EffectsFrom = None,
        json: Json = False,
    ) -> None:
        """Write a model as URDF, MJCF, SDF, YAML, or as a C function of its effects.

        Base parameters are no bodies: the nearest rigid bodies are written, and the output says how
        far that moves the torque.
        """
        start()
        from jaxswarm import tasks
        from jaxswarm.effects import register_from

        weight = {} if prior_weight is None else {"prior_weight": prior_weight}
        bodies = None if prior is None else Path(prior)
        side = (out.with_name(f"{out.name}.json"),)
        with work(out, (model, log, bodies, effects_from), beside=side) as status:
            if effects_from:
                register_from(effects_from)
            result = tasks.export(
                model, out, format, log=log, prior=prior, **weight, progress=status
            )
        show(result, json)

    @app.command(
        epilog="Example: jaxswarm simulate out/model.json --reference trajectory.csv --out motion.csv"
    )
    @with_log_options("reference")
    def simulate(
        model: ModelFile,
        reference: Annotated[
            Path, typer.Option(help="Positions over time: a log, or trajectory.csv of excite.")
        ],
        out: Annotated[Path, typer.Option("--out", help="CSV file to write.")],
        kp: Annotated[
            str | None, typer.Option(help="Gain [N m/rad], one or one a joint; default 5 Hz loop.")
        ] = None,
        kd: Annotated[str | None, typer.Option(help="Gain [N m s/rad], likewise.")] = None,
        feedforward: Annotated[
            str, typer.Option(help="rigid: the rigid body's torque is fed forward; none.")
        ] = "rigid",
        playback: Annotated[
            bool, typer.Option("--playback", help="Drive with the reference's torques instead.")
        ] = False,
        rate: Annotated[
            float | None, typer.Option(help="Samples a second; default the reference's.")
        ] = None,
        effects_from: EffectsFrom = None,
        json: Json = False,
    ) -> None:
        """Simulate what the arm does with its effects, under a PD controller or by given torques.

        The CSV holds what a log would: t, q, dq, ddq and tau, at the encoders.
        """
        start()
        from jaxswarm import outputs, tasks
        from jaxswarm.effects import register_from
        from jaxswarm.logs import write_log

        _check_csv(out)
        outputs.check_folder(out.parent)
        gains = {"kp": numbers(kp, "--kp"), "kd": numbers(kd, "--kd")}
        with work(out, (model, reference, effects_from)) as status:
            if effects_from:
                register_from(effects_from)
            result = tasks.simulate(
                model, reference, **gains, feedforward=feedforward, playback=playback, rate=rate,
                progress=status,
            )  # fmt: skip
            outputs.write_told(out.parent, {out.name: lambda part: write_log(result.log, part)})
        result.content["out"] = str(out)
        show(result, json, f"written to {out}")

    @app.command(
        epilog="Example: jaxswarm compare monday/identification.json friday/identification.json"
    )
    def compare(
        a: Annotated[Path, typer.Argument(help="model, identification or diagnosis as .json.")],
        b: Annotated[Path, typer.Argument(help="Another one of the same kind.")],
        json: Json = False,
    ) -> None:
        """Put two models, identifications or diagnoses side by side; mark what differs."""
        start()
        from jaxswarm import tasks

        show(tasks.compare(a, b), json)


def _check_csv(out: Path) -> None:
    if out.is_dir() or out.suffix.lower() != ".csv":
        raise InputError(f"--out {out}: name a file that ends in .csv, such as motion.csv")
