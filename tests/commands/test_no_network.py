"""No command reaches for the network, nor do the processes it starts; ``fetch`` alone may."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from slide import EFFECTS, slide_log

ROOT = Path(__file__).resolve().parents[2]
# Every Python that starts with this on its path is watched, those that draw pictures too.
WATCH = """
import os, sys

def watch(event, given):
    names = event in ("socket.getaddrinfo", "socket.gethostbyname", "socket.gethostbyaddr")
    if names or (event in ("socket.connect", "socket.sendto") and isinstance(given[1], tuple)):
        with open(os.environ["REACHED"], "a") as file:
            file.write(f"{event} {given}\\n")
        raise OSError("the network is closed")

sys.addaudithook(watch)
"""
COMMANDS = """
import sys
from jaxswarm.cli import main
for words in {commands}:
    sys.argv = ["jaxswarm", *words]
    try:
        main()
    except SystemExit as end:
        assert not end.code, (words, end.code)
"""


@pytest.fixture
def watched(tmp_path):
    (tmp_path / "watch").mkdir()
    (tmp_path / "watch" / "sitecustomize.py").write_text(WATCH)
    reached = tmp_path / "reached"
    path = os.pathsep.join([str(tmp_path / "watch"), str(ROOT)])

    def run(code):
        words = [sys.executable, "-c", code]
        surroundings = {**os.environ, "PYTHONPATH": path, "REACHED": str(reached)}
        ended = subprocess.run(
            words, cwd=tmp_path, env=surroundings, capture_output=True, text=True
        )
        return ended, reached.read_text() if reached.exists() else ""

    return run


def test_a_connection_is_seen(watched):
    ended, reached = watched("import socket; socket.create_connection(('192.0.2.1', 9))")
    assert ended.returncode and "192.0.2.1" in reached


def test_commands_stay_on_this_machine(watched, tmp_path):
    (tmp_path / "log.csv").write_text("\n".join(slide_log()) + "\n")
    fit = ["identify", "log.csv", "--robot", "emps", "--effects", EFFECTS, "--out", "out"]
    commands = [
        ["inspect", "log.csv", "--robot", "emps"],
        fit,
        ["predict", "out/model.json", "log.csv", "--out", "torque.csv"],
        ["export", "out/model.json", "--format", "yaml", "--out", "model.yaml"],
        ["compare", "out/identification.json", "out/identification.json"],
    ]
    ended, reached = watched(COMMANDS.format(commands=commands))
    assert (ended.returncode, reached) == (0, ""), ended.stderr
    assert (tmp_path / "out" / "torque.png").exists() and (tmp_path / "torque.csv").exists()
