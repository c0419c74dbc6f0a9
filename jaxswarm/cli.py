"""The command line: parse, call one library function, print. Results on stdout, the rest on stderr."""

import gc
import os
import sys
from math import isfinite
from pathlib import Path
from typing import Annotated

import typer

from jaxswarm import console, terminal
from jaxswarm.cli_robot import RobotName, robot_commands, with_robot_options
from jaxswarm.commands import register
from jaxswarm.commands.options import EffectsFrom
from jaxswarm.errors import InputError, printable
from jaxswarm.work import run, work

app = typer.Typer(
    name="jaxswarm",
    help="Finds the physical effect a robot model lacks, adds it, and shows the error before and after.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)

Logs = Annotated[list[Path], typer.Argument(help="Logs to fit: CSV, NPZ, Parquet, MAT or MCAP.")]
Out = Annotated[Path, typer.Option("--out", help="Folder for the results.")]
Validation = Annotated[Path | None, typer.Option("--validation", help="Log to score on.")]
# Seeds are 64-bit integers with a sign wherever random numbers are made.
_LARGEST_SEED = 2**63 - 1
# Runs and steps are counted in 32 bits on devices.
_MOST = 2**31 - 1
Seed = Annotated[
    int, typer.Option(min=0, max=_LARGEST_SEED, help="Draws whatever is drawn; repeats exactly.")
]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON on stdout.")]


def _finite(number: float | None) -> float | None:
    if number is not None and not isfinite(number):
        raise typer.BadParameter(f"{number} is no finite number.")
    return number


MotionCutoff = Annotated[
    float | None,
    typer.Option(
        min=0.01, callback=_finite, help="Low-pass of the motion [Hz]; found from the data."
    ),
]
TorqueCutoff = Annotated[
    float | None,
    typer.Option(min=0.01, callback=_finite, help="Low-pass shared by torque and model [Hz]."),
]


Accept = Annotated[
    list[str] | None,
    typer.Option(help="Fit a log in spite of this finding about it; may be repeated."),
]


# What the commands write into their folder, and would overwrite there.
_IDENTIFIED = ("model.json", "identification.json")
_DIAGNOSED = ("model.json", "diagnosis.json", "report.html")
_EXCITED = ("trajectory.csv", "excitation.json")


def main() -> None:
    """Run the command line; bad input ends with one message and exit code 2."""
    run(lambda: app(args=console.modes_first(sys.argv[1:]), standalone_mode=True))


@app.callback()
def modes(
    quiet: Annotated[
        bool, typer.Option("--quiet", help="Print nothing but errors, and the result of --json.")
    ] = False,
    plain: Annotated[
        bool, typer.Option("--plain", help="ASCII without colors, for logs and other programs.")
    ] = False,
) -> None:
    """Finds the physical effect a robot model lacks, adds it, and shows the error before and after."""
    console.set_modes(quiet, plain)


def _start() -> None:
    """Double precision, one thread for small matrices, and compiled code kept on disk between commands."""
    # Threads of OpenBLAS wait for each other by spinning: on a busy machine the QR of 500 x 70 numbers
    # takes a hundred times longer than with one. Read when numpy is first imported, hence here.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Imports and tracing make many objects that stay: to look for garbage among them after every 700
    # takes a tenth of a short run.
    gc.set_threshold(100_000, 20, 20)
    home = terminal.find_home()
    import jax

    jax.config.update("jax_enable_x64", True)
    cache = os.environ.get("XDG_CACHE_HOME") or (home and home / ".cache")
    if "JAX_COMPILATION_CACHE_DIR" not in os.environ and cache:
        jax.config.update("jax_compilation_cache_dir", str(Path(cache) / "jaxswarm" / "compiled"))
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.1)


app.add_typer(robot_commands(_start), name="robots", epilog="Example: jaxswarm robots --json")


@app.command(epilog="Example: jaxswarm demo --seed 3")
def demo(
    seed: Annotated[
        int,
        typer.Option(min=0, max=_LARGEST_SEED, help="Draws the arm, its motion and the effect."),
    ] = 0,
    out: Annotated[Path, typer.Option("--out", help="Folder for the report.")] = Path("out/demo"),
    json: Json = False,
) -> None:
    """Make an RX60 log with an undeclared effect, find it, and only then show the truth."""
    _start()
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
    _start()
    from jaxswarm.errors import nearest
    from jaxswarm.outputs import check_folder
    from jaxswarm.studies import STUDIES

    if name not in STUDIES:
        raise InputError(f"unknown study {name!r}. {nearest(name, STUDIES)}")
    check_folder(out)
    with work(out, (), ("report.html",)) as status:
        result = STUDIES[name](out, fast=fast, seed=seed, progress=status)
    console.show(result, json, lambda: print(printable(f"report: {out / 'report.html'}")))


@app.command(
    epilog="Example: jaxswarm identify arm.csv --robot arm.urdf --effects viscous_friction --out out"
)
@with_robot_options(_start)
def identify(
    logs: Logs,
    robot: RobotName,
    effects: Annotated[str, typer.Option(help="none, or name[@joint[:partner]],...")],
    out: Out,
    validation: Validation = None,
    optimizer: Annotated[str, typer.Option(help="least_squares or a swarm.")] = "least_squares",
    runs: Annotated[int, typer.Option(min=1, max=_MOST, help="Runs of the swarm.")] = 10,
    steps: Annotated[int, typer.Option(min=1, max=_MOST, help="Steps of the swarm.")] = 500,
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
    _start()
    from jaxswarm.effects import register_from
    from jaxswarm.effects.bodies import with_free_base
    from jaxswarm.identify import print_identification
    from jaxswarm.identify.run import Options, identify_files

    effects = with_free_base(effects) if free_base else effects
    options = Options(
        optimizer, runs, steps, whiten, seed, motion_cutoff, torque_cutoff,
        estimator, physical, prior, prior_weight, tuple(accept or ()),
    )  # fmt: skip
    inputs = (*logs, validation, prior and Path(prior), Path(robot), effects_from)
    with work(out, inputs, _IDENTIFIED) as status:
        if effects_from:
            register_from(effects_from)
        report = identify_files(logs, robot, effects, out, validation, options, status)
    console.notes([*report["logs"], *report["validation_logs"]])
    console.show(
        report, json, lambda: print_identification(console.safe(report), console.safe(out))
    )


@app.command(
    epilog="Example: jaxswarm diagnose arm.csv --robot arm.urdf --declare viscous_friction --out found"
)
@with_robot_options(_start)
def diagnose(
    logs: Logs,
    robot: RobotName,
    out: Out,
    declare: Annotated[
        str | None,
        typer.Option(help="What is known to be there: none, or name[@joint[:partner]],..."),
    ] = None,
    model: Annotated[
        Path | None, typer.Option(help="model.json identified before: find what changed since.")
    ] = None,
    validation: Annotated[
        list[Path] | None, typer.Option(help="Log to score on; may be repeated.")
    ] = None,
    seed: Seed = 0,
    motion_cutoff: MotionCutoff = None,
    torque_cutoff: TorqueCutoff = None,
    accept: Accept = None,
    discover: Annotated[
        bool,
        typer.Option("--discover", help="Search a formula for what no known law explains."),
    ] = False,
    effects_from: EffectsFrom = None,
    json: Json = False,
) -> None:
    """Find the effect a declared model lacks, add it, and show the error before and after."""
    _start()
    from jaxswarm.diagnose import print_diagnosis
    from jaxswarm.diagnose.run import diagnose_files
    from jaxswarm.effects import register_from
    from jaxswarm.identify.run import Options

    options = Options(
        seed=seed,
        motion_cutoff=motion_cutoff,
        torque_cutoff=torque_cutoff,
        accept=tuple(accept or ()),
        discover=discover,
    )
    if model is not None and declare is not None:
        raise InputError("--declare and --model exclude each other; a model holds what is declared")
    if model is not None and discover:
        raise InputError("--discover goes with --declare: against a model nothing is searched")
    inputs = (*logs, *(validation or ()), model, Path(robot), effects_from)
    with work(out, inputs, _DIAGNOSED, resumable=True) as status:
        if effects_from:
            register_from(effects_from)
        if model is not None:
            from jaxswarm.diagnose.run_against import compare_files

            result = compare_files(logs, robot, model, out, validation, options, status)
        else:
            declare = declare or "none"
            result = diagnose_files(logs, robot, declare, out, validation, options, status)
    console.notes([*result["logs"], *result.get("validation_logs", ())])
    console.show(result, json, lambda: print_diagnosis(console.safe(result), console.safe(out)))


@app.command(epilog="Example: jaxswarm predict out/model.json other.csv --out torque.csv")
def predict(
    model: Annotated[Path, typer.Argument(help="model.json of identify or diagnose.")],
    log: Annotated[Path, typer.Argument(help="Log of the motion; torque is not needed.")],
    out: Annotated[Path, typer.Option("--out", help="CSV file to write.")],
    effects_from: EffectsFrom = None,
    json: Json = False,
) -> None:
    """Predict the torque of an identified model along a log, at its own time stamps."""
    _start()
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
@with_robot_options(_start)
def excite(
    robot: RobotName,
    limits: Annotated[Path, typer.Option(help="TOML file: what every joint may do.")],
    out: Out,
    effects: Annotated[
        str | None,
        typer.Option(
            help="What will be identified: none, or name[@joint[:partner]],...; default: viscous and "
            "dry friction of every joint."
        ),
    ] = None,
    duration: Annotated[
        float | None, typer.Option(min=0.1, help="Length [s]; default one period.")
    ] = None,
    seed: Seed = 0,
    json: Json = False,
) -> None:
    """Plan a motion within limits on which the parameters can be told apart best."""
    _start()
    from jaxswarm.identify.excite_run import excite_file, print_excitation

    with work(out, (limits, Path(robot)), _EXCITED) as status:
        result = excite_file(robot, limits, out, effects, duration, seed, status)
    console.show(result, json, lambda: print_excitation(console.safe(result), console.safe(out)))


@app.command(epilog="Example: jaxswarm effects --json")
def effects(json: Json = False) -> None:
    """List the effects: what can be declared and what is asked of a residual."""
    _start()
    from jaxswarm.effects import REGISTRY

    rows = [
        {
            "effect": law.name,
            "scope": law.scope,
            "law": law.summary,
            "parameters": {
                p.name: {"unit": p.unit, "lower": p.lower, "upper": p.upper, "linear": p.linear}
                for p in law.parameters
            },
            "reference": law.reference,
        }
        for law in sorted(REGISTRY.values(), key=lambda law: law.name)
    ]
    console.table(rows, json, ("effect", "scope", "law", "reference"))


@app.command(epilog="Example: jaxswarm optimizers --json")
def optimizers(json: Json = False) -> None:
    """List the optimizers and the papers they come from."""
    _start()
    from jaxswarm.swarm import OPTIMIZERS

    rows = [
        {
            "optimizer": name,
            "about": entry.description,
            "reference": entry.reference,
            "reconstruction": entry.reconstruction,
        }
        for name, entry in OPTIMIZERS.items()
    ]
    console.table(rows, json, ("optimizer", "about", "reference"))


register(app, _start)
