"""The options of every command that takes a robot, and the commands about robots.

A command declares ``robot: RobotName`` and is decorated with :func:`with_robot_options`; what it gets then
is the name together with the options.
"""

import functools
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from jaxswarm import console
from jaxswarm.commands.options import Json, widened
from jaxswarm.errors import InputError
from jaxswarm.runtime import start

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
            help="MASS,X,Y,Z[,IXX,IXY,IYY,IXZ,IYZ,IZZ]: a body on the last link, in its frame (kg, m).",
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
            print(f"note: {choice}: {note}", file=sys.stderr)
        return result

    return widened(run, command, _OPTIONS)


def register(app: typer.Typer) -> None:
    """Add ``robots`` and ``robots show``."""
    commands = typer.Typer(invoke_without_command=True)

    @commands.callback()
    def robots(context: typer.Context, json: Json = False) -> None:
        """List the built-in robots; ``robots show ROBOT`` prints and draws one."""
        if context.invoked_subcommand is not None:
            return
        from jaxswarm.catalog import BUILTIN

        rows = [
            {"robot": name, "joints": list(joints), "about": about}
            for name, (joints, about) in sorted(BUILTIN.items())
        ]
        console.table(rows, json, ("robot", "joints", "about"))

    @commands.command()
    @with_robot_options
    def show(robot: RobotArgument, out: Picture = None, json: Json = False) -> None:
        """Print what was read of a robot, and draw it: robots show arm.urdf --out arm.png."""
        from jaxswarm.effects.advice import with_effects
        from jaxswarm.robot import RobotChoice
        from jaxswarm.robot.show import draw, print_robot, summary

        choice = robot if isinstance(robot, RobotChoice) else RobotChoice(robot)
        result = summary(choice)
        result["notes"] = with_effects(result["notes"])
        if out is not None:
            draw(choice, out)
        console.show(result, json, lambda: print_robot(result))

    app.add_typer(commands, name="robots", epilog="Example: jaxswarm robots --json")
