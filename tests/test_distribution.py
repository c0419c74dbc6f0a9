"""Wheel and sdist: what they hold, and that the wheel works from another place, without the source tree."""

import importlib.util
import os
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

import jaxswarm

ROOT = Path(__file__).resolve().parents[1]
needs_build = pytest.mark.skipif(
    importlib.util.find_spec("hatchling") is None, reason="no hatchling"
)
# Runs from the unpacked wheel alone: the version, the command's help, and a small piece of work.
PROGRAM = """
import sys
sys.path[:] = [p for p in sys.path if p != sys.argv[1]]
sys.path.insert(0, sys.argv[2])
import jaxswarm
assert jaxswarm.__file__.startswith(sys.argv[2]), jaxswarm.__file__
arm = jaxswarm.load_robot("rx60")
print(jaxswarm.__version__, arm.num_joints)
"""


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Wheel and sdist, built by the build backend itself."""
    place = tmp_path_factory.mktemp("built")
    code = (
        "from hatchling.build import build_sdist, build_wheel; "
        f"build_wheel({str(place)!r}); build_sdist({str(place)!r})"
    )
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True)
    return next(place.glob("*.whl")), next(place.glob("*.tar.gz"))


@needs_build
def test_the_wheel_holds_the_package_and_nothing_else(built):
    names = zipfile.ZipFile(built[0]).namelist()
    package = {p.relative_to(ROOT).as_posix() for p in (ROOT / "jaxswarm").rglob("*.py")}
    assert package <= set(names)
    for name in ("py.typed", "CHANGES.md", "__init__.pyi"):
        assert f"jaxswarm/{name}" in names
    assert {name.split("/")[0].split("-")[0] for name in names} == {"jaxswarm"}
    assert built[0].name.startswith(f"jaxswarm-{jaxswarm.__version__}-py3-none-any")


@needs_build
def test_the_sdist_can_be_built_from(built):
    names = {name.partition("/")[2] for name in tarfile.open(built[1]).getnames()}
    assert {"pyproject.toml", "README.md", "LICENSE", "jaxswarm/__init__.py"} <= names


@needs_build
def test_the_wheel_works_without_the_source_tree(built, tmp_path):
    zipfile.ZipFile(built[0]).extractall(tmp_path / "site")
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(ROOT), str(tmp_path / "site")],
        cwd=tmp_path, capture_output=True, text=True, env=environment,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [jaxswarm.__version__, "3"]
