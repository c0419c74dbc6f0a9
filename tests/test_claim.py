"""An output is never an input, one command works in one place, and bad numbers end in a message."""

import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from slide import EFFECTS, assert_refused, identify, run, slide_log

from jaxswarm.claim import claim
from jaxswarm.errors import InputError

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def identified(tmp_path_factory):
    folder = tmp_path_factory.mktemp("claim")
    (folder / "log.csv").write_text("\n".join(slide_log()) + "\n")
    code, _, err = identify(folder / "log.csv", folder / "out")
    assert code == 0, err
    return folder


@pytest.mark.parametrize(
    "way", ["same", "relative", "symlink", "hardlink", "by a folder to be made"]
)
@pytest.mark.parametrize("victim", ["log.csv", "out/model.json"])
def test_predict_never_writes_over_what_it_reads(identified, tmp_path, monkeypatch, victim, way):
    target = identified / victim
    before = target.read_bytes()
    out = tmp_path / "link"
    if way == "symlink":
        out.symlink_to(target)
    elif way == "hardlink":
        os.link(target, out)
    elif way == "relative":
        monkeypatch.chdir(identified / "out")
        out = Path(os.path.relpath(target))
    elif way == "by a folder to be made":
        out = target.parent / "new" / ".." / target.name
    else:
        out = target
    model = identified / "out" / "model.json"
    assert_refused(run("predict", model, identified / "log.csv", "--out", out), "overwrite")
    assert target.read_bytes() == before


URDF = """<robot name="r"><link name="a"/><link name="b"/><joint name="slide" type="prismatic">
<parent link="a"/><child link="b"/><axis xyz="1 0 0"/></joint></robot>"""


@pytest.mark.parametrize(
    ("victim", "words"),
    [
        # The file beside the robot, which holds what a URDF cannot, would have the model's name.
        ("m.json", ("export", "m.json", "--format", "urdf", "--out", "m")),
        ("c.toml", ("predict", "m.json", "log.csv", "--columns", "c.toml", "--out", "c.toml")),
        ("arm.urdf", ("robots", "show", "arm.urdf", "--out", "arm.urdf")),
    ],
)
def test_no_command_writes_over_what_it_reads(identified, tmp_path, monkeypatch, victim, words):
    (tmp_path / "m.json").write_bytes((identified / "out" / "model.json").read_bytes())
    (tmp_path / "log.csv").write_bytes((identified / "log.csv").read_bytes())
    (tmp_path / "c.toml").write_text('[columns]\nt = { unit = "s" }\n')
    (tmp_path / "arm.urdf").write_text(URDF)
    monkeypatch.chdir(tmp_path)
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    assert_refused(run(*words), victim, "overwrite")
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == before


@pytest.mark.parametrize(
    "words",
    [
        ("predict", "m.json", "log.csv", "--out", "own.csv"),
        ("simulate", "m.json", "--reference", "log.csv", "--out", "own.csv"),
        ("export", "m.json", "--format", "yaml", "--out", "own.csv"),
        ("robots", "show", "arm.urdf", "--out", "own.png"),
    ],
)
def test_what_is_overwritten_is_told_once(identified, tmp_path, monkeypatch, words):
    (tmp_path / "m.json").write_bytes((identified / "out" / "model.json").read_bytes())
    (tmp_path / "log.csv").write_bytes((identified / "log.csv").read_bytes())
    (tmp_path / "arm.urdf").write_text(URDF)
    out = words[-1]
    (tmp_path / out).write_text("hours of work")
    monkeypatch.chdir(tmp_path)
    found = [run(*words) for _ in range(2)]
    assert [code for code, _, _ in found] == [0, 0], found
    assert [err.count(f"overwritten: {out}") for _, _, err in found] == [1, 0]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes in this file system")
@pytest.mark.parametrize(
    "words",
    [
        ("predict", "m.json", "log.csv", "--out", "pipe"),
        ("export", "m.json", "--format", "urdf", "--out", "pipe"),
        ("robots", "show", "arm.urdf", "--out", "pipe"),
        ("identify", "log.csv", "--robot", "arm.urdf", "--effects", "none", "--out", "out"),
    ],
)
def test_no_file_takes_the_place_of_a_device_or_a_pipe(identified, tmp_path, monkeypatch, words):
    (tmp_path / "m.json").write_bytes((identified / "out" / "model.json").read_bytes())
    (tmp_path / "log.csv").write_bytes((identified / "log.csv").read_bytes())
    (tmp_path / "arm.urdf").write_text(URDF)
    (tmp_path / "out").mkdir()
    for name in ("pipe", "out/model.json"):
        os.mkfifo(tmp_path / name)
    monkeypatch.chdir(tmp_path)
    assert_refused(run(*words), "is a device or a pipe")
    assert (tmp_path / "pipe").is_fifo() and (tmp_path / "out" / "model.json").is_fifo()
    assert len(list((tmp_path / "out").iterdir())) == 1


@pytest.mark.parametrize("name", ["x" * 300 + ".csv", "y/" * 2500 + "log.csv"])
def test_a_name_that_no_file_system_takes_is_no_failure_of_printing(tmp_path, name):
    result = identify(name, tmp_path / "out")
    assert_refused(result, "File name too long", "Check the path")


def test_a_diagnosis_never_writes_over_its_model(identified):
    model = identified / "out" / "model.json"
    before = model.read_bytes()
    arguments = ("--robot", "emps", "--model", model, "--out", identified / "out")
    assert_refused(run("diagnose", identified / "log.csv", *arguments), "model.json", "overwrite")
    assert model.read_bytes() == before


def test_two_commands_in_one_place(identified, tmp_path):
    code = (
        "import sys; from pathlib import Path; from jaxswarm.claim import claim\n"
        "with claim(Path(sys.argv[1]), (), ('a',)): print('held', flush=True); sys.stdin.read()"
    )
    other = subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path / "out")],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    )
    try:
        assert other.stdout.readline() == b"held\n"
        (tmp_path / "way").symlink_to(tmp_path)
        for place in (tmp_path / "out", tmp_path / "way" / "out"):
            assert_refused(identify(identified / "log.csv", place), "another command")
        with claim(tmp_path / "elsewhere", (), ("a",)):
            pass
    finally:
        other.kill()
        other.communicate()
    # The lock ends with its process, however that ended.
    assert identify(identified / "log.csv", tmp_path / "out")[0] == 0


def test_a_place_is_free_again_after_the_work(tmp_path):
    for _ in range(2):
        with claim(tmp_path / "out", ()):
            with pytest.raises(InputError, match="another command"), claim(tmp_path / "out", ()):
                pass


def test_no_lock_is_left_and_one_that_was_is_no_hindrance(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()
    with claim(tmp_path / "out", ()):
        (lock,) = (tmp_path / "temporary").iterdir()
    assert not lock.exists()
    lock.touch()  # as a killed command leaves it
    with claim(tmp_path / "out", ()):
        pass
    assert not lock.exists()


def test_of_many_at_once_one_works_at_a_time(tmp_path):
    """Locks are removed while others ask for them: never do two commands hold one place."""
    code = (
        "import os, sys; from pathlib import Path; from jaxswarm.claim import claim\n"
        "from jaxswarm.errors import InputError\n"
        "held = 0\n"
        "while held < 200:\n"
        "    try:\n"
        "        with claim(Path(sys.argv[1]), ()):\n"
        "            os.close(os.open(sys.argv[2], os.O_CREAT | os.O_EXCL))\n"
        "            os.unlink(sys.argv[2]); held += 1\n"
        "    except InputError:\n"
        "        pass\n"
    )
    words = [sys.executable, "-c", code, str(tmp_path / "out"), str(tmp_path / "held")]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    every = [subprocess.Popen(words, env=environment) for _ in range(3)]
    assert [one.wait(timeout=60) for one in every] == [0, 0, 0]


@pytest.mark.parametrize(
    "error",
    [
        np.linalg.LinAlgError("SVD did not converge"),
        ZeroDivisionError("float division by zero"),
        FloatingPointError("overflow"),
        OverflowError("too large"),
        MemoryError("Unable to allocate 70 GiB"),
    ],
)
def test_numerical_failures_name_the_log_and_the_stage(identified, tmp_path, monkeypatch, error):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr(import_module("jaxswarm.identify.run"), "estimate_with_clocks", fail)
    result = identify(identified / "log.csv", tmp_path / "out")
    assert_refused(result, "log.csv", "fitting", str(error))
    assert not (tmp_path / "out").exists()


def test_a_mistake_of_ours_stays_visible(identified, tmp_path, monkeypatch):
    def fail(*_, **__):
        raise KeyError("no such thing")

    monkeypatch.setattr(import_module("jaxswarm.identify.run"), "estimate_with_clocks", fail)
    with pytest.raises(KeyError):
        identify(identified / "log.csv", tmp_path / "out")


def test_the_same_term_twice_is_refused(identified, tmp_path):
    log, out = identified / "log.csv", tmp_path / "out"
    twice = f"{EFFECTS},viscous_friction@slide"
    assert_refused(identify(log, out, effects=twice), "twice")
    declared = ("--robot", "emps", "--declare", twice, "--out", out)
    assert_refused(run("diagnose", log, *declared), "twice")
