"""The changelog is in the package and says what the version in the package is about."""

import re
import tomllib
from importlib.resources import files
from pathlib import Path

import jaxswarm

ROOT = Path(__file__).resolve().parents[1]


def test_the_newest_entry_is_of_this_version():
    text = (files(jaxswarm) / "CHANGES.md").read_text(encoding="utf-8")
    assert re.findall(r"^## (\S+)$", text, re.MULTILINE)[0] == jaxswarm.__version__


def test_the_version_has_one_place():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert "version" in project["project"]["dynamic"] and "version" not in project["project"]
    assert project["tool"]["hatch"]["version"]["path"] == "jaxswarm/__init__.py"
