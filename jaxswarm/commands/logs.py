"""The options of every command that reads logs: names, units and parts that a file does not tell.

A command is decorated with :func:`with_log_options`; every path of a log that it gets carries what the
options say, :class:`jaxswarm.logs.LogChoice`.
"""

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from jaxswarm.commands.options import widened
from jaxswarm.runtime import start
from jaxswarm.work import has_read

_OPTIONS = {
    "columns": Annotated[
        str | None,
        typer.Option(
            "--columns",
            help="Names and units of a log, OURS=THEIRS:UNIT,... as t:ms,q=pos_{k}:deg; or a .toml file.",
        ),
    ],
    "topic": Annotated[
        str | None,
        typer.Option(
            "--topic",
            help="Topic of a recording; structure, group or episode of a file with several.",
        ),
    ],
    "side": Annotated[
        str | None,
        typer.Option("--side", help="motor or link, where a log has q or tau of both."),
    ],
    "effort": Annotated[
        str | None,
        typer.Option("--effort", help="torque or current: what the efforts of a log are."),
    ],
}


def with_log_options(*parameters: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Give a command the options about logs; ``parameters`` of it are paths or addresses of logs, or lists."""

    def decorate(command: Callable[..., Any]) -> Callable[..., Any]:
        @functools.wraps(command)
        def run(**arguments: Any) -> Any:
            texts = {name: arguments.pop(name) for name in _OPTIONS}
            if any(text is not None for text in texts.values()):
                start()
                from jaxswarm.logs import LogChoice, parse_reading

                reading = parse_reading(**texts)
                if texts["columns"] is not None:
                    has_read(Path(texts["columns"]))
                for name in parameters:
                    paths = arguments[name]
                    if isinstance(paths, str | Path):
                        arguments[name] = LogChoice(paths, reading)
                    elif paths is not None:
                        arguments[name] = [LogChoice(path, reading) for path in paths]
            return command(**arguments)

        return widened(run, command, _OPTIONS)

    return decorate
