"""The README says what is true: its commands, names and examples."""

import re
from pathlib import Path

import pytest

from jaxswarm.cli import app
from jaxswarm.effects import REGISTRY
from jaxswarm.robot import BUILTIN_ROBOTS
from jaxswarm.swarm import OPTIMIZERS

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.MULTILINE | re.DOTALL)


def table(heading):
    """Names in backticks in the first column of the table under a heading."""
    section = README.split(f"## {heading}\n")[1].split("\n## ")[0]
    rows = [line.split("|")[1] for line in section.splitlines() if line.startswith("| `")]
    return [name for row in rows for name in re.findall(r"`([^`]+)`", row)]


def test_ci_runs_the_command_of_the_readme():
    command = re.search(r'^test_command="(.*)"$', (ROOT / ".ci" / "run").read_text(), re.MULTILINE)
    assert command and command[1] + "\n" in blocks("sh")


def test_the_first_command_is_the_demo():
    assert blocks("sh")[0].strip().endswith("jaxswarm demo")
    assert README.index("jaxswarm demo") < 1200


@pytest.mark.parametrize(("heading", "known"), [("Effects", REGISTRY), ("Optimizers", OPTIMIZERS)])
def test_tables_name_everything_there_is(heading, known):
    assert sorted(table(heading)) == sorted(known)


def test_commands_and_robots_are_named():
    for command in app.registered_commands:
        name = command.name or command.callback.__name__
        assert re.search(rf"`(jaxswarm )?{name}\b", README), name
    for name in BUILTIN_ROBOTS:
        assert f"`{name}`" in README


@pytest.mark.parametrize("number", range(len(blocks("python"))))
def test_examples_run(number, monkeypatch, capsys, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("jaxswarm.effects.base.REGISTRY", dict(REGISTRY))
    exec(compile(blocks("python")[number], "README.md", "exec"), {})
    if number == 1:
        assert "e-" in capsys.readouterr().out
    if number == 2:
        assert "The model lacked coulomb_friction on slide" in capsys.readouterr().out
        assert {path.name for path in tmp_path.iterdir()} == {"torque.png", "model.json"}


def test_the_first_screen_is_one_screen():
    first = README[: README.index("\n## ")]
    assert len(first.splitlines()) <= 40
    assert "jaxswarm demo" in first and "jaxswarm diagnose arm.csv" in first
    titles = {line.lstrip("# ").lower() for line in README.splitlines() if line.startswith("## ")}
    linked = re.findall(r"\]\(#([a-z-]+)\)", first)
    assert (
        {re.sub(r"[^a-z ]", "", title).replace(" ", "-") for title in titles}
        >= set(linked)
        != set()
    )
    assert README.index("## Effects") < 5500
    assert len(README.splitlines()) < 330


def test_license():
    text = (ROOT / "LICENSE").read_text()
    assert "Apache License" in text and "Version 2.0, January 2004" in text
    assert "Copyright 2026 The jaxswarm authors" in text
