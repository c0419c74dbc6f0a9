"""What can be measured here, what each measurement needs and how long it takes.

    python -m benchmarks                         list them
    python -m benchmarks --compare A B           ratios of two result files (JSON lines)

A benchmark is a module or a package of this folder that can be run. Its docstring says what it measures and
how to call it, ``NEEDS`` (packages that it imports beyond the core, or ``data``) and ``TAKES`` the rest; they
are read without importing it.
"""

import argparse
import ast
import importlib.util
import os
import sys
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.compare import compare
from jaxswarm.errors import InputError

FOLDER = Path(__file__).parent
DATA = "data"
"""Stands among the needs for the folder of measured logs."""


class Benchmark(NamedTuple):
    """One module that measures: its docstring's first line and call, needs and time."""

    name: str
    what: str
    call: str
    needs: tuple[str, ...]
    takes: str


def benchmarks(folder: Path = FOLDER) -> list[Benchmark]:
    """Read the modules and packages of a folder that can be run, in the order of their names."""
    files = [*folder.glob("*.py"), *folder.glob("*/__main__.py")]
    return [one for path in sorted(files) if (one := _read(path, folder)) is not None]


def _read(path: Path, folder: Path) -> Benchmark | None:
    text = path.read_text(encoding="utf-8")
    name = path.stem if path.parent == folder else path.parent.name
    if name.startswith("__") or '__name__ == "__main__"' not in text:
        return None
    tree = ast.parse(text)
    stated: dict[str, Any] = {"NEEDS": (), "TAKES": "not stated"}
    for node in tree.body:
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", None) in stated:
            stated[node.targets[0].id] = ast.literal_eval(node.value)
    lines = [line.strip() for line in (ast.get_docstring(tree) or "").splitlines()] or [""]
    called = f"python -m benchmarks.{name}"
    call = next((line[line.index(called) :] for line in lines if called in line), called)
    return Benchmark(name, lines[0], call, tuple(stated["NEEDS"]), stated["TAKES"])


def listing(found: list[Benchmark]) -> str:
    """One paragraph a benchmark; what is missing here is said."""
    lines = []
    for one in found:
        needs = ", ".join(n + ("" if _present(n) else " (missing)") for n in one.needs)
        lines += [
            f"{one.name}: {one.what}",
            f"    {one.call}",
            f"    needs {needs or 'nothing more'}; takes {one.takes}",
        ]
    lines.append(f"\nResults go to {FOLDER / 'results'} as JSON lines: --compare A B shows ratios.")
    return "\n".join(lines)


def _present(need: str) -> bool:
    if need == DATA:
        root = os.environ.get("JAXSWARM_DATA", FOLDER.parent.parent / "shared")
        return (Path(root) / DATA).is_dir()
    return importlib.util.find_spec(need) is not None


def main(arguments: list[str] | None = None) -> None:
    """Print the list or the comparison; bad input is one message and exit code 2."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--compare", nargs=2, metavar=("A", "B"), type=Path, help="result files")
    parser.add_argument("--by", metavar="FIELDS", help="what tells rows apart, with commas")
    options = parser.parse_args(arguments)
    if options.by is not None and options.compare is None:
        parser.error("--by belongs to --compare")
    if options.compare is None:
        print(listing(benchmarks()))
        return
    try:
        print(compare(*options.compare, by=options.by.split(",") if options.by else None))
    except InputError as error:
        print(error, file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
