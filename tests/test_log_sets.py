"""Logs as sets and with pauses, through the commands: no evidence twice, every stamp answered."""

import json
import os

import numpy as np
import pytest
from slide import EFFECTS, assert_refused, identify, run, slide_log


def rows(length=3000, seed=0):
    return [[float(cell) for cell in line.split(",")] for line in slide_log(length, seed)[1:]]


def write(path, table, header="t,q_slide,tau_slide"):
    lines = [header, *(",".join(f"{x:.9g}" for x in row) for row in table)]
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("sets")
    write(path / "log.csv", rows(1500))
    code, _, err = identify(path / "log.csv", path / "out")
    assert code == 0, err
    return path


def paused(length=3000, seconds=10.0):
    """Of another recording than that of the folder."""
    return [
        [t + seconds * (k >= length // 2), *rest] for k, (t, *rest) in enumerate(rows(length, 1))
    ]


def test_the_same_log_twice_is_refused(folder, tmp_path):
    copy = tmp_path / "copy.csv"
    copy.write_bytes((folder / "log.csv").read_bytes())
    log, out = folder / "log.csv", tmp_path / "out"
    assert_refused(identify(log, out, copy), "copy.csv", "same", "log.csv")
    assert_refused(identify(log, out, "--validation", log), "same")
    assert_refused(identify(log, out, "--validation", copy), "same")
    given = ("--robot", "emps", "--out", out)
    assert_refused(run("diagnose", log, copy, *given), "same")
    assert_refused(run("diagnose", log, "--validation", copy, *given), "same")
    model = folder / "out" / "model.json"
    assert_refused(run("diagnose", log, copy, "--model", model, *given), "same")


def test_a_pause_changes_nothing(folder, tmp_path):
    log = write(tmp_path / "paused.csv", paused())
    code, out, err = identify(log, tmp_path / "out", "--json", "--validation", folder / "log.csv")
    assert code == 0, err
    report = json.loads(out)
    values = {row["name"]: row["value"] for row in report["base_parameters"]}
    assert values["m1"] == pytest.approx(20, rel=0.01)
    assert values["fc_slide"] == pytest.approx(5, rel=0.05)
    assert any("Split at 1 gap" in note for note in report["logs"][0]["notes"])
    assert "Split at 1 gap" in err and "paused.csv" in err


def test_validation_and_prediction_across_pauses(folder, tmp_path):
    table = paused(1500)
    table[700:750] = [[t + 3.0, *rest] for t, *rest in table[700:750]]
    # Short and shorter islands between two pauses, down to one sample.
    table = [[t + 2.0 * (k >= 1480) + 2.0 * (k >= 1490) + 2.0 * (k >= 1499), *rest]
             for k, (t, *rest) in enumerate(table)]  # fmt: skip
    table.sort()
    log = write(tmp_path / "paused.csv", table)
    log.write_text(log.read_text())
    more = ("--json", "--validation", log)
    code, out, err = identify(folder / "log.csv", tmp_path / "out", *more)
    assert code == 0, err
    assert json.loads(out)["error"]["validation"]["relative_global"] < 0.05
    assert "paused.csv" in err
    code, out, err = run("predict", folder / "out/model.json", log, "--out", tmp_path / "p.csv")
    assert code == 0, err
    predicted = np.loadtxt(tmp_path / "p.csv", delimiter=",", skiprows=1)
    assert np.allclose(predicted[:, 0], [row[0] for row in table])
    assert np.isfinite(predicted).all()
    measured = np.array([row[2] for row in table])
    error = np.abs(predicted[:, 1] - measured)[:700]
    assert np.quantile(error, 0.9) < 0.05 * measured.std()


@pytest.mark.parametrize("term", ["payload", "contact", "contact,payload"])
def test_what_needs_a_reference_cannot_be_declared(folder, tmp_path, term):
    out = tmp_path / "out"
    assert_refused(identify(folder / "log.csv", out, effects=term), term[:7], "--model")
    given = ("--robot", "emps", "--declare", term, "--out", out)
    assert_refused(run("diagnose", folder / "log.csv", *given), term[:7], "--model")


def test_a_declared_channel_has_to_be_there(folder, tmp_path):
    out = tmp_path / "out"
    effects = f"{EFFECTS},temperature_friction"
    assert_refused(identify(folder / "log.csv", out, effects=effects), "temperature_slide")
    given = ("--robot", "emps", "--declare", effects, "--out", out)
    assert_refused(run("diagnose", folder / "log.csv", *given), "temperature_slide")
    warm = [[*row, 25.0 + 0.01 * k] for k, row in enumerate(rows(600))]
    log = write(tmp_path / "warm.csv", warm, "t,q_slide,tau_slide,temperature_slide")
    assert identify(log, out, effects=effects)[0] == 0


def test_a_declared_spring_without_stiffness(folder, tmp_path):
    code, out, err = identify(
        folder / "log.csv", tmp_path / "out", "--json", effects=f"{EFFECTS},joint_spring"
    )
    assert code == 0, err
    assert "Infinity" not in out


def test_every_command_prints_the_notes_of_its_logs(folder, tmp_path):
    # Less than two seconds: a diagnosis says at once that it cannot decide.
    table = [[*row, 1.0 if k % 2 else -1.0] for k, row in enumerate(rows(190))]
    log = write(tmp_path / "odd.csv", table, "t,q_slide,tau_slide,dq_slide")
    given = ("--robot", "emps", "--out", tmp_path / "out")
    commands = [
        ("identify", log, "--effects", EFFECTS, *given),
        ("diagnose", log, "--declare", EFFECTS, *given),
        ("predict", folder / "out" / "model.json", log, "--out", tmp_path / "p.csv"),
    ]
    for command in commands:
        code, out, err = run(*command)
        assert code == 0, err
        assert "note: " in err and "odd.csv: The logged velocity contradicts" in err
        # A diagnosis lists among its results what it found wrong with its logs.
        assert ("contradicts" in out) == (command[0] == "diagnose")
        code, out, err = run(*command, "--json")
        assert code == 0 and json.loads(out)
        assert "contradicts" in out and "contradicts" in err


def test_a_dead_torque_is_refused_by_every_fit(folder, tmp_path):
    log = write(tmp_path / "dead.csv", [[t, q, 0.0] for t, q, _ in rows(1000)])
    given = ("--robot", "emps", "--out", tmp_path / "out")
    assert_refused(identify(log, tmp_path / "out"), "dead.csv", "torque of slide", "dead")
    assert_refused(run("diagnose", log, *given), "torque of slide", "dead")
    model = ("--model", folder / "out" / "model.json")
    assert_refused(run("diagnose", log, *model, *given), "torque of slide", "dead")
    assert_refused(identify(folder / "log.csv", tmp_path / "out", "--validation", log), "dead")
    assert run("predict", model[1], log, "--out", tmp_path / "p.csv")[0] == 0


def test_a_recording_that_is_a_folder_proves_nothing_about_itself(tmp_path):
    from jaxswarm.errors import InputError
    from jaxswarm.identify.run import refuse_repeated

    for name, content in (("one", b"motion"), ("two", b"motion"), ("three", b"another")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "metadata.yaml").write_bytes(b"rosbag2")
        (tmp_path / name / "bag.mcap").write_bytes(content)
    refuse_repeated([tmp_path / "one", tmp_path / "three"])
    with pytest.raises(InputError, match="two: holds the same as .*one"):
        refuse_repeated([tmp_path / "one", tmp_path / "two"])


def test_a_large_log_of_its_own_size_is_not_read_to_be_compared(tmp_path, monkeypatch):
    from jaxswarm.identify import run as module

    def fails(*given):
        raise AssertionError("hashed")

    for name, size in (("one", 20 * 2**30), ("two", 20 * 2**30 + 1)):
        (tmp_path / name).touch()
        os.truncate(tmp_path / name, size)  # without a byte on disk
    monkeypatch.setattr(module.hashlib, "file_digest", fails)
    module.refuse_repeated([tmp_path / "one", tmp_path / "two"])
