"""Pictures on order: the other process draws what this one would, and what it cannot is drawn here."""

import os
import subprocess
import sys
import time

import numpy as np
import pytest

from jaxswarm import drawing, plots

T = np.linspace(0.0, 4.0, 60)
TORQUE = np.stack([np.sin(T), np.cos(T)], axis=1)
ORDER = ("plots.torque_overlay", T, TORQUE, 0.9 * TORQUE, ("a", "b$c"), ("N m", "N"), "title")


def here() -> bytes:
    return plots.png_bytes(plots.torque_overlay(*ORDER[1:]))


def test_another_process_draws_the_same(monkeypatch):
    with drawing.Drawing() as own:
        if own._process is None:
            pytest.skip("a single core draws here")
        own.ask("one.png", *ORDER)
        monkeypatch.setattr(drawing, "draw", None)  # nothing is left for this process
        assert own.finished() == {"one.png": here()}


@pytest.mark.parametrize("failure", ["one core", "no process", "killed", "unknown"])
def test_what_it_cannot_draw_is_drawn_here(monkeypatch, failure):
    def refuse(*args, **more):
        raise OSError("no more processes")

    if failure == "one core":
        monkeypatch.setattr(drawing.cores, "count", lambda: 1)
    if failure == "no process":
        monkeypatch.setattr(drawing.subprocess, "Popen", refuse)
    with drawing.Drawing() as own:
        if failure == "killed" and own._process:
            own._process.kill()
            own._process.wait()
        own.ask("one.png", *ORDER)
        if failure == "unknown" and own._folder:  # the other process ends with an error
            for order in drawing.Path(own._folder.name).glob("*.order"):
                order.write_bytes(b"no pickle")
        assert own.finished() == {"one.png": here()}


def test_nothing_stays_behind():
    with drawing.Drawing() as own:
        process, folder = own._process, own._folder
        own.ask("one.png", *ORDER)
    if process is not None:
        assert process.poll() is not None and not drawing.Path(folder.name).exists()


def test_what_a_killed_command_ordered_is_removed(tmp_path):
    code = (
        "import time; from jaxswarm import drawing\n"
        "with drawing.Drawing() as own:\n"
        "    own.ask('one.png', 'plots.convergence', {}, 1.0)\n"
        "    print(own._folder.name if own._process else '', flush=True); time.sleep(60)"
    )
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    words = [sys.executable, "-c", code]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, env=environment) as command:
        folder = command.stdout.readline().strip()
        if folder:
            assert drawing.Path(folder).parent == tmp_path
        command.kill()
    end = time.monotonic() + 30.0
    while folder and drawing.Path(folder).exists() and time.monotonic() < end:
        time.sleep(0.05)
    assert not folder or not drawing.Path(folder).exists()


def test_drawing_needs_no_jax():
    code = "import sys, jaxswarm.drawing, jaxswarm.plots; sys.exit('jax' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_orders_are_drawn_at_the_same_time(monkeypatch):
    with drawing.Drawing() as own:
        if own._process is None:
            pytest.skip("a single core draws here")
        for name in ("one.png", "two.png", "three.png"):
            own.ask(name, *ORDER)
        monkeypatch.setattr(drawing, "draw", None)
        assert own.finished() == dict.fromkeys(("one.png", "two.png", "three.png"), here())
