"""The command ``diagnose``: files, exit codes, and nothing written on bad input."""

import json
import sys

import numpy as np
import pytest

from jaxswarm.cli import main
from jaxswarm.identify.synthetic import demo_case, synthetic_log
from jaxswarm.robot import rx60


def command(monkeypatch, *arguments) -> int:
    monkeypatch.setattr(sys, "argv", ["jaxswarm", "diagnose", *map(str, arguments)])
    with pytest.raises(SystemExit) as stop:
        main()
    return stop.value.code or 0


@pytest.fixture(scope="module")
def log_file(tmp_path_factory):
    arm, declared, hidden = demo_case(rx60(), 3)
    log = synthetic_log(arm, (*declared, *hidden), 3, duration=10.0, rate=125.0)
    path = tmp_path_factory.mktemp("logs") / "arm.npz"
    np.savez(path, t=log.t, q=log.q, tau=log.tau, joints=np.array(log.joints))
    return path, hidden[0]


def test_files_and_exit_code(monkeypatch, log_file, tmp_path, capsys):
    path, hidden = log_file
    out = tmp_path / "out"
    code = command(
        monkeypatch, path, "--robot", "rx60", "--out", out, "--json",
        "--declare", "viscous_friction,coulomb_friction",
    )  # fmt: skip
    assert code == 0
    names = {p.name for p in out.iterdir()}
    assert {"diagnosis.json", "model.json", "report.html", "residual.png", "ladder.png"} <= names
    printed = json.loads(capsys.readouterr().out)
    written = json.loads((out / "diagnosis.json").read_text())
    assert printed["verdict"] == written["verdict"] == "explained"
    assert [e["effect"] for e in written["effects"]] == [hidden.effect]


def test_a_log_too_short_to_judge_has_a_page_too(monkeypatch, log_file, tmp_path, capsys):
    short, out = tmp_path / "short.npz", tmp_path / "out"
    with np.load(log_file[0]) as whole:
        np.savez(short, **{k: whole[k] if k == "joints" else whole[k][:150] for k in whole.files})
    assert command(monkeypatch, short, "--robot", "rx60", "--out", out) == 0
    assert "cannot be judged" in capsys.readouterr().out
    written = json.loads((out / "diagnosis.json").read_text())
    assert written["verdict"] == "cannot be judged"
    assert written["provenance"]["inputs"][0]["name"] == "short.npz"
    page = (out / "report.html").read_text()
    assert "Cannot be judged" in page and written["reasons"][0].split(";")[0] in page


BAD = [
    (["--declare", "stribek_friction"], "stribeck_friction"),
    (["--declare", "coulomb_friction@joint9"], "joint9"),
    (["--robot", "rx61"], "rx60"),
    (["--validation", "absent.npz"], "absent.npz"),
]


@pytest.mark.parametrize(("options", "told"), BAD)
def test_bad_options_are_refused_and_nothing_is_written(
    monkeypatch, log_file, tmp_path, capsys, options, told
):
    out = tmp_path / "out"
    arguments = [log_file[0], "--out", out, *options]
    if "--robot" not in options:
        arguments += ["--robot", "rx60"]
    assert command(monkeypatch, *arguments) == 2
    error = capsys.readouterr().err
    assert told in error and "Traceback" not in error
    assert not out.exists()


def test_validation_log_without_motion_to_use_is_refused_before_the_work(
    monkeypatch, log_file, tmp_path, capsys
):
    short = tmp_path / "short.npz"
    with np.load(log_file[0]) as whole:
        np.savez(short, **{k: whole[k] if k == "joints" else whole[k][:5] for k in whole.files})
    out = tmp_path / "out"
    code = command(monkeypatch, log_file[0], "--robot", "rx60", "--out", out, "--validation", short)
    assert code == 2
    assert "short.npz" in capsys.readouterr().err
    assert not out.exists()


def test_log_of_another_robot_is_refused(monkeypatch, tmp_path, capsys):
    path = tmp_path / "two.npz"
    t = np.arange(500) * 0.01
    q = np.sin(np.stack([t, 2 * t], axis=1))
    np.savez(path, t=t, q=q, tau=q)
    out = tmp_path / "out"
    assert command(monkeypatch, path, "--robot", "rx60", "--out", out) == 2
    assert "two.npz" in capsys.readouterr().err
    assert not out.exists()
