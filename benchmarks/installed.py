"""Wheel and sdist in environments of their own: the oldest and the newest Python and packages promised.

    python -m benchmarks.installed [--pythons python3.11,python3.13] [--work FOLDER]

The wheel goes to the first Python with the lower bounds of pyproject.toml to the letter, the sdist to the
last one with the newest packages that pip finds. In both, far from the source tree, the demo runs, a few
commands, and tests that need nothing but the package (their folder is copied). Environments stay in
--work. Exit code 1 if anything failed; `.ci/daily` calls this.
"""

import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path
from typing import NamedTuple

NEEDS = ("hatchling",)
TAKES = "a quarter of an hour, with packages fetched"

ROOT = Path(__file__).resolve().parents[1]
# What the tests import beside the package.
_TOOLS = ("pytest", "hypothesis")
# One file of every room that asks for no other package and no data.
_TESTS = (
    *(
        "swarm/test_minimize.py",
        "swarm/test_pso.py",
        "swarm/test_cma.py",
        "swarm/test_checkpoint.py",
    ),
    *("effects/test_formulas.py", "logs/test_gaps.py", "logs/test_filtering.py"),
    *("identify/test_estimate.py", "identify/test_least_squares.py", "diagnose/test_page.py"),
    *(
        "diagnose/test_decide.py",
        "simulate/test_rollout.py",
        "tasks/test_compare.py",
        "test_tables.py",
    ),
)
_COMMANDS = (
    ("demo", "--out", "demo"),
    ("doctor",),
    ("effects",),
    ("robots", "show", "ur10e", "--out", "ur10e.png"),
    ("compare", "demo", "demo"),
    ("export", "demo/model.json", "--out", "arm.urdf"),
)


class Row(NamedTuple):
    """What was done in an environment, how it ended, and the processor's time [s] in it."""

    environment: str
    what: str
    outcome: str
    seconds: float


def lower_bounds() -> list[str]:
    """The oldest packages that pyproject.toml allows, as pip wants them."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return [need.replace(">=", "==") for need in project["dependencies"]]


def built(folder: Path) -> tuple[Path, Path]:
    """Wheel and sdist."""
    code = (
        "from hatchling.build import build_sdist, build_wheel; "
        f"build_wheel({str(folder)!r}); build_sdist({str(folder)!r})"
    )
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True)
    return next(folder.glob("*.whl")), next(folder.glob("*.tar.gz"))


def environment(python: str, place: Path, package: Path, others: list[str]) -> Path:
    """A fresh environment with a built package; its folder of programs."""
    subprocess.run([python, "-m", "venv", "--clear", str(place)], check=True)
    words = ["-m", "pip", "install", "-q", str(package), *others, *_TOOLS]
    subprocess.run([str(place / "bin" / "python"), *words], check=True)
    return place / "bin"


def _tried(words: list[str], folder: Path) -> tuple[str, float]:
    """How a program ended, and the processor's time in it; the source tree is not on its path."""
    surroundings = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run(words, cwd=folder, env=surroundings, capture_output=True, text=True)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    last = [line for line in (done.stdout + done.stderr).splitlines() if line.strip()][-1:]
    return ("done" if done.returncode == 0 else f"exit {done.returncode}: {last}"), seconds


def rows(name: str, programs: Path, folder: Path) -> list[Row]:
    """Run the commands and the tests in an environment, in a folder of their own."""
    folder.mkdir(parents=True)
    told = []
    for command in _COMMANDS:
        ended = _tried([str(programs / "jaxswarm"), *command], folder)
        told.append(Row(name, f"jaxswarm {' '.join(command)}", *ended))
    shutil.copytree(ROOT / "tests", folder / "tests")
    words = [
        str(programs / "python"),
        "-m",
        "pytest",
        "-q",
        "--no-header",
        "-p",
        "no:cacheprovider",
    ]
    for test in _TESTS:
        told.append(Row(name, test, *_tried([*words, f"tests/{test}"], folder)))
    return told


def versions(programs: Path) -> str:
    """Python and the packages that matter, as they are there."""
    code = (
        "import platform; from importlib.metadata import version; "
        "print('Python', platform.python_version(), *(f'{n} {version(n)}' for n in ('jax', 'numpy', 'scipy')))"
    )
    done = subprocess.run([str(programs / "python"), "-c", code], capture_output=True, text=True)
    return done.stdout.strip()


def main() -> None:
    """Print one table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--pythons", default="python3.11,python3.13", help="oldest and newest")
    parser.add_argument("--work", type=Path, help="folder for the environments")
    options = parser.parse_args()
    oldest, newest = options.pythons.split(",")
    work = options.work or Path(tempfile.mkdtemp())
    work.mkdir(parents=True, exist_ok=True)
    wheel, sdist = built(Path(tempfile.mkdtemp(dir=work)))
    failed = 0
    print("| environment | what | outcome | user s |\n|---|---|---|---|", flush=True)
    for python, package, others in ((oldest, wheel, lower_bounds()), (newest, sdist, [])):
        programs = environment(python, work / Path(python).name, package, others)
        name = f"{package.suffix[1:]}, {versions(programs)}"
        for row in rows(name, programs, Path(tempfile.mkdtemp(dir=work)) / "run"):
            print(
                f"| {row.environment} | {row.what} | {row.outcome} | {row.seconds:.0f} |",
                flush=True,
            )
            failed += row.outcome != "done"
    if failed:
        sys.exit(f"{failed} of these did not end well")


if __name__ == "__main__":
    main()
