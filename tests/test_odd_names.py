"""Joints with names that file systems, formulas, markup, tables or pages take for something else."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
from slide import run

from jaxswarm.logs import Log, read_log
from jaxswarm.logs.write import write_log
from jaxswarm.plots import panels, png_bytes, torque_overlay

NAMES = ["a/b", "$x_{$", "[/b]", "=1+1", "<script>", 'say "hi"', "φ"]


def arm(path, name):
    """A slide with a joint of any name."""
    path.write_text(
        f'name = "slide"\n[[joint]]\nname = {json.dumps(name, ensure_ascii=False)}\n'
        'kind = "prismatic"\naxis = [1, 0, 0]\n',
        encoding="utf-8",
    )
    return path


def motion(name):
    t = np.arange(800) * 0.01
    q, dq = np.sin(3 * t) + 0.3 * np.sin(7 * t), 3 * np.cos(3 * t) + 2.1 * np.cos(7 * t)
    ddq = -9 * np.sin(3 * t) - 14.7 * np.sin(7 * t)
    noise = 0.1 * np.random.default_rng(0).normal(size=800)
    tau = 2 * ddq + dq + np.tanh(dq / 0.01) + noise
    return Log("made", (name,), t, q[:, None], tau=tau[:, None])


@pytest.mark.parametrize("name", NAMES)
def test_every_command_takes_any_name(tmp_path, name):
    robot, log, out = arm(tmp_path / "arm.toml", name), tmp_path / "log.csv", tmp_path / "out"
    write_log(motion(name), log)
    assert read_log(log, (name,)).joints == (name,)
    code, text, err = run(
        "identify", log, "--robot", robot, "--effects", "viscous_friction", "--out", out
    )
    assert code == 0, err
    assert name in text
    code, _, err = run("predict", out / "model.json", log, "--out", tmp_path / "pred.csv")
    assert code == 0, err
    with open(tmp_path / "pred.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    assert rows[0] == ["t", f"tau_{name}"]
    assert {len(row) for row in rows} == {2}


def test_a_diagnosis_takes_the_worst_of_names(tmp_path):
    name = "".join(NAMES[:4]) + "<script>"
    robot, log, out = arm(tmp_path / "arm.toml", name), tmp_path / "log.csv", tmp_path / "out"
    clean = motion(name)
    write_log(replace(clean, tau=clean.tau + 3 * np.sin(2.3 * clean.q**2)), log)
    code, text, err = run("diagnose", log, "--robot", robot, "--out", out)
    assert code == 0, err
    assert name in text.replace("\n", "")
    assert {path.parent for path in out.iterdir()} == {out}
    page = (out / "report.html").read_text(encoding="utf-8")
    assert name not in page and f"{name[-9]}<script>" not in page and "&lt;script&gt;" in page


def test_formulas_in_names_are_drawn_as_they_are():
    t = np.arange(50.0)
    figure = torque_overlay(t, t[:, None], t[:, None], ["$x_{$"], ["N"], "log\udcff")
    assert png_bytes(figure).startswith(b"\x89PNG")


def test_powers_of_ten_stay_formulas():
    figure, (axis,) = panels(1, 1, 3.0, 2.0)
    axis.semilogy([1, 2], [1e-5, 1e5])
    png_bytes(figure)
    assert all(label.get_parse_math() for label in axis.get_yticklabels())
