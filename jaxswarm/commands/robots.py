"""The options of every command that takes a robot, and the commands about robots.

A command declares ``robot: RobotName`` and is decorated with :func:`with_robot_options`; what it gets then
is the name together with the options.
"""

import functools
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from jaxswarm import console
from jaxswarm.commands.options import Json, widened
from jaxswarm.commands.options import show as show_result
from jaxswarm.errors import InputError
from jaxswarm.runtime import start
from jaxswarm.work import work

if TYPE_CHECKING:
    from jaxswarm.tables import Result

RobotName = Annotated[
    str, typer.Option("--robot", help="Built-in name, .urdf, .sdf, .xml (MJCF) or .toml file.")
]
RobotArgument = Annotated[
    str, typer.Argument(help="Built-in name, .urdf, .sdf, .xml (MJCF) or .toml file.")
]
Picture = Annotated[
    Path | None, typer.Option("--out", help="PNG file: the skeleton with its axes.")
]
_OPTIONS = {
    "joints": Annotated[
        str | None,
        typer.Option("--joints", help="A,B,...: joints of interest; every other one is locked."),
    ],
    "lock": Annotated[
        str | None,
        typer.Option(
            "--lock", help="A[=POSITION],...: joints held still (rad, m), by default at 0."
        ),
    ],
    "tool": Annotated[
        str | None,
        typer.Option(
            "--tool",
            help="MASS,X,Y,Z of a body on the last link, in its frame (kg, m); its inertia may follow: "
            "IXX, IXY, IYY, IXZ, IYZ, IZZ (kg m^2).",
        ),
    ],
    "gravity": Annotated[
        str | None, typer.Option("--gravity", help="X,Y,Z: free fall in base axes (m/s^2).")
    ],
}


def with_robot_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command with a parameter ``robot`` the options about it; the robot's notes go to stderr."""

    @functools.wraps(command)
    def run(**arguments: Any) -> Any:
        texts = {name: arguments.pop(name) for name in _OPTIONS}
        start()
        from jaxswarm.effects.advice import with_effects
        from jaxswarm.robot import RobotChoice, describe_robot, parse_options

        if arguments["robot"] is None:
            if given := [f"--{name}" for name, text in texts.items() if text is not None]:
                raise InputError(f"{', '.join(given)}: belongs to --robot; name the robot")
            return command(**arguments)
        choice = RobotChoice(arguments["robot"], parse_options(**texts))
        result = command(**{**arguments, "robot": choice})
        for note in with_effects(describe_robot(choice).notes):
            console.note(f"{choice}: {note}")
        return result

    return widened(run, command, _OPTIONS)


def register(app: typer.Typer) -> None:
    """Add ``robots`` and ``robots show``."""
    commands = typer.Typer(invoke_without_command=True)

    @commands.callback()
    def robots(context: typer.Context, json: Json = False) -> None:
        """List the built-in robots; 'robots show ROBOT' prints and draws one."""
        if context.invoked_subcommand is not None:
            return
        from jaxswarm.catalog import BUILTIN

        rows = [
            {"robot": name, "joints": list(joints), "about": about}
            for name, (joints, about) in sorted(BUILTIN.items())
        ]
        console.table(rows, json, ("robot", "joints", "about"))

    @commands.command(epilog="Example: jaxswarm robots show arm.urdf --out arm.png")
    @with_robot_options
    def show(robot: RobotArgument, out: Picture = None, json: Json = False) -> None:
        """Print what was read of a robot, and draw it."""
        from jaxswarm import outputs
        from jaxswarm.effects.advice import with_effects
        from jaxswarm.robot import RobotChoice
        from jaxswarm.robot.show import draw, summary

        choice = robot if isinstance(robot, RobotChoice) else RobotChoice(robot)
        result = summary(choice)
        result["notes"] = with_effects(result["notes"])
        if out is not None:
            outputs.check_file(out)
            with work(out, (Path(choice),)):
                if out.suffix.lower() != ".png":
                    raise InputError(f"--out {out}: name a file that ends in .png, such as arm.png")
                outputs.write_told(out.parent, {out.name: lambda part: draw(choice, part)})
        show_result(_shown(result), json)

    app.add_typer(commands, name="robots", epilog="Example: jaxswarm robots --json")


def _shown(result: dict[str, Any]) -> "Result":
    """What :func:`jaxswarm.robot.show.summary` returned, with the table of its joints."""
    import numpy as np

    from jaxswarm.tables import Result, Table

    heavy, rows = result["mass"] > 0.0, []
    for row in result["joints"]:
        axis = " ".join(f"{round(x, 2):g}" for x in row["axis"])
        bounds = [row["lower"], row["upper"]]
        unit = "m" if row["kind"] == "prismatic" else "rad"
        known = not np.isnan(bounds).any()
        limits = f"{bounds[0]:.4g} .. {bounds[1]:.4g} {unit}" if known else "none given"
        mass = (f"{row['mass']:.4g}",) if heavy else ()
        rows.append((row["joint"], row["kind"], row["parent"], axis, limits, *mass))
    head = ("joint", "kind", "parent", "axis", "limits", *(["mass [kg]"] if heavy else []))
    table = Table("", head, tuple(rows))
    gravity = " ".join(f"{g:g}" for g in result["gravity"])
    total = f"mass of the moving links: {result['mass']:.5g} kg"
    lines = (
        f"{result['robot']}: {len(rows)} moving joints, gravity {gravity} m/s^2",
        total
        if heavy
        else "no masses in the file: kinematics are enough to identify and to diagnose",
    )
    return Result(result, lines, (table,))
