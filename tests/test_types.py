"""Types: the package passes mypy as pyproject says, and who uses it is told what its functions give."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

import jaxswarm
from jaxswarm import tasks

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = """
import jax
import jaxswarm
from jaxswarm.tables import Result

space = jaxswarm.Space(x=(-5.0, 5.0))
found = jaxswarm.minimize(lambda p, a: p["x"] ** 2, jaxswarm.gpso(), space, jax.random.key(0), num_steps=5)
reveal_type(found)
arm = jaxswarm.load_robot("rx60")
reveal_type(arm)
reveal_type(jaxswarm.read_log("arm.csv", arm.joints))
reveal_type(jaxswarm.identify("arm.csv", arm, "none"))
diagnosed: Result = jaxswarm.diagnose("arm.csv", arm, "none")
"""
WRONG = """
import jaxswarm

jaxswarm.load_robot(3)
jaxswarm.read_log("arm.csv")
jaxswarm.no_such_name
"""

needs_mypy = pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="no mypy")


def mypy(*words, folder):
    """What mypy says, with the settings of the project."""
    command = [sys.executable, "-m", "mypy", "--config-file", str(ROOT / "pyproject.toml")]
    cache = ["--cache-dir", str(folder / "cache")]
    return subprocess.run([*command, *cache, *words], capture_output=True, text=True, cwd=ROOT)


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("types")


@needs_mypy
def test_the_package_passes(cache):
    done = mypy(folder=cache)
    assert done.returncode == 0, done.stdout


@needs_mypy
def test_a_program_is_told_what_it_gets(cache):
    (cache / "program.py").write_text(PROGRAM)
    done = mypy(str(cache / "program.py"), folder=cache)
    assert done.returncode == 0, done.stdout
    for kind in (
        "jaxswarm.swarm.result.Result",
        "jaxswarm.robot.model.Robot",
        "jaxswarm.logs.log.Log",
        "jaxswarm.tasks.identification.Fitted",
    ):
        assert f'Revealed type is "{kind}' in done.stdout, done.stdout


@needs_mypy
def test_a_wrong_program_is_told_so(cache):
    (cache / "wrong.py").write_text(WRONG)
    said = mypy(str(cache / "wrong.py"), folder=cache).stdout
    assert "[arg-type]" in said and "[call-arg]" in said and "[attr-defined]" in said


def test_the_stub_names_what_the_package_names():
    text = (ROOT / "jaxswarm" / "__init__.pyi").read_text(encoding="utf-8")
    homes = {name: f"jaxswarm.tasks.{module}" for name, module in tasks._PLACES.items()}
    wanted = {
        f"from {homes.get(name, place)} import {name} as {name}"
        for place, names in jaxswarm._PLACES.items()
        for name in names
    }
    assert {line for line in text.splitlines() if line.startswith("from")} == wanted
    assert (ROOT / "jaxswarm" / "py.typed").is_file()
