"""Models, results, limits and columns that are devices, pipes or far too large end in a message at once."""

import os

import pytest
from slide import assert_refused, run, slide_log

from jaxswarm import documents
from jaxswarm.errors import InputError


@pytest.fixture
def log(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("\n".join(slide_log()) + "\n")
    return path


def asked(log, document, out):
    robot = ("--robot", "emps")
    return [
        ("predict", document, log, "--out", out / "p.csv"),
        ("diagnose", log, *robot, "--model", document, "--out", out),
        ("compare", document, document),
        ("excite", *robot, "--limits", document, "--out", out),
        ("identify", log, *robot, "--effects", "none", "--columns", document, "--out", out),
    ]


@pytest.mark.parametrize("number", range(5))
def test_a_pipe_is_not_waited_for(log, tmp_path, number):
    pipe = tmp_path / "document.toml"
    os.mkfifo(pipe)
    out = tmp_path / "out"
    assert_refused(run(*asked(log, pipe, out)[number]), "document.toml", "device or a pipe")
    assert not out.exists()


@pytest.mark.parametrize("number", range(5))
def test_a_file_of_gigabytes_is_not_read(log, tmp_path, monkeypatch, number):
    large = tmp_path / "document.toml"
    large.touch()
    os.truncate(large, 8 * 2**30)  # without a byte on disk
    out = tmp_path / "out"
    assert_refused(run(*asked(log, large, out)[number]), "document.toml", "8590 MB")
    assert not out.exists()


def test_what_cannot_be_read_is_left_to_the_caller(tmp_path, monkeypatch):
    with pytest.raises(FileNotFoundError):
        documents.read_document(tmp_path / "none.json")
    with pytest.raises(IsADirectoryError):
        documents.read_document(tmp_path)
    (tmp_path / "a.json").write_text("αβ", encoding="utf-8")
    assert documents.read_document(tmp_path / "a.json") == "αβ"
    monkeypatch.setattr(documents, "LARGEST", 3)
    with pytest.raises(InputError, match="a.json: has"):
        documents.read_document(tmp_path / "a.json")
