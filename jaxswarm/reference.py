"""The reference, generated from the code: ``python -m jaxswarm.reference > reference.md``."""

import inspect
import re
from collections.abc import Iterator
from importlib import import_module
from typing import Any

import jaxswarm
from jaxswarm.effects import REGISTRY, Effect
from jaxswarm.swarm import OPTIMIZERS
from jaxswarm.work import run

_HOW_TO = (
    "jaxswarm.howto.your_robot",
    "jaxswarm.howto.your_log",
    "jaxswarm.howto.your_effect",
    "jaxswarm.swarm.own",
    "jaxswarm.howto.reading_a_verdict",
    "jaxswarm.howto.scale",
    "jaxswarm.howto.what_it_cannot_see",
)


def main() -> None:
    """Print the reference as Markdown."""
    print(markdown())


def markdown() -> str:
    """How to go on, and all effects, optimizers, commands and public names, one chapter each."""
    chapters = (
        ("How to", _how_to()),
        ("Effects", _effects()),
        ("Optimizers", _optimizers()),
        ("Commands", _commands()),
        ("Python", _names()),
    )
    lines = [f"# jaxswarm {jaxswarm.__version__}: reference"]
    for title, content in chapters:
        lines += ["", f"## {title}", *content]
    return "\n".join(lines)


def _how_to() -> Iterator[str]:
    for name in _HOW_TO:
        words = inspect.cleandoc(import_module(name).__doc__ or "")
        title, _, content = words.partition("\n\n")
        yield from ("", f"### {title.rstrip('.')}")
        for block in content.split("\n\n"):
            shown = f"```python\n{block}\n```" if block.startswith(">>>") else block
            yield from ("", shown.replace("``", "`") if shown is block else shown)


def _effects() -> Iterator[str]:
    for law in sorted(REGISTRY.values(), key=lambda law: law.name):
        yield from ("", f"### `{law.name}`", "", f"Law: {law.summary}", "")
        if law.meaning:
            yield from (law.meaning, "")
        yield from (f"Acts on: {_scope(law)}. Source: {law.reference}.", "")
        yield from (
            "| parameter | unit | from | to | usual | enters | meaning |",
            "|---|---|---|---|---|---|---|",
        )
        for p in law.parameters:
            enters = "linear" if p.linear else "searched" if p.fitted else "chosen"
            yield _row(
                f"`{p.name}`", p.unit, f"{p.lower:g}", f"{p.upper:g}", f"{p.nominal:g}", enters,
                p.description,
            )  # fmt: skip


def _scope(law: Effect) -> str:
    return {"joint": "a joint", "pair": "two joints", "global": "the whole arm"}[law.scope]


def _optimizers() -> Iterator[str]:
    yield from ("", "| optimizer | about | source |", "|---|---|---|")
    for name, entry in OPTIMIZERS.items():
        about = entry.description + (" (reconstruction)" if entry.reconstruction else "")
        yield _row(f"`{name}`", about, entry.reference)


def _commands() -> Iterator[str]:
    # The command line is built here only, since it is the one part that needs typer.
    import typer

    from jaxswarm.cli import app

    top: Any = typer.main.get_command(app)
    for name, command in top.commands.items():
        yield from _command(f"jaxswarm {name}", command)


def _command(path: str, command: Any) -> Iterator[str]:
    yield from ("", f"### `{path}`", "", _line(command.help))
    if command.epilog:
        yield from ("", f"Example: `{command.epilog.removeprefix('Example: ')}`")
    rows = [_row(_option(p), _line(getattr(p, "help", "")), _default(p)) for p in command.params]
    if rows:
        yield from ("", "| argument or option | meaning | default |", "|---|---|---|", *rows)
    for name, below in getattr(command, "commands", {}).items():
        yield from _command(f"{path} {name}", below)


def _option(parameter: Any) -> str:
    argument = parameter.param_type_name == "argument"
    name = parameter.name.upper() if argument else ", ".join(parameter.opts)
    return f"`{name}`"


def _default(parameter: Any) -> str:
    if parameter.required:
        return "required"
    return "" if parameter.default in (None, False) else f"`{parameter.default}`"


def _names() -> Iterator[str]:
    yield from ("", "| name | what it is |", "|---|---|")
    for name in jaxswarm.__all__:
        thing = getattr(jaxswarm, name)
        yield _row(f"`jaxswarm.{name}{signature(thing)}`", first_sentence(thing))


def signature(thing: Any) -> str:
    """What a function or class is called with, without types; empty for anything else.

    >>> signature(first_sentence)
    '(thing)'
    """
    if not callable(thing):
        return ""
    try:
        found = inspect.signature(thing)
    except ValueError:  # built in C
        return "(...)"
    plain = [p.replace(annotation=p.empty) for p in found.parameters.values()]
    text = str(found.replace(parameters=plain, return_annotation=found.empty))
    # An address in memory differs from run to run.
    return re.sub(r" at 0x[0-9a-f]+", "", text)


def first_sentence(thing: Any) -> str:
    """The first sentence of a docstring; for plain data, what it is.

    >>> first_sentence(first_sentence)
    'The first sentence of a docstring; for plain data, what it is.'
    """
    if isinstance(thing, dict | tuple | list):
        return f"{type(thing).__name__} of {len(thing)}: {', '.join(map(str, thing))}"
    return _line((inspect.getdoc(thing) or "").split("\n\n")[0])


def _line(text: str | None) -> str:
    return " ".join((text or "").split())


def _row(*cells: str) -> str:
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in map(_line, cells))} |"


if __name__ == "__main__":
    run(main)
