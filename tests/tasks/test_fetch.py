"""Fetching: from files of this machine by the same way, and one sentence where there is no connection."""

import hashlib
import sys

import pytest

from jaxswarm.errors import InputError
from jaxswarm.tasks.fetching import SOURCES, Source, fetch


@pytest.fixture
def local(tmp_path):
    pytest.importorskip("pooch")
    (tmp_path / "public").mkdir()
    (tmp_path / "public" / "a run.csv").write_text("t,q1\n0,1\n")
    base = (tmp_path / "public").as_uri() + "/"
    return {"set": Source(base, ("a run.csv",), "CC0", "Nobody, 2020", "a test")}


def test_files_arrive_with_checksum_licence_and_citation(local, tmp_path):
    found = fetch("set", tmp_path / "data", sources=local)
    path = tmp_path / "data" / "set" / "a run.csv"
    assert path.read_text() == "t,q1\n0,1\n"
    assert found["sha256"] == {"a run.csv": hashlib.sha256(path.read_bytes()).hexdigest()}
    assert "CC0" in repr(found) and "Nobody, 2020" in repr(found)


def test_a_file_that_changed_is_refused(local, tmp_path):
    fetch("set", tmp_path / "data", sources=local)
    (tmp_path / "public" / "a run.csv").write_text("t,q1\n0,2\n")
    with pytest.raises(InputError, match="not the file that was fetched before"):
        fetch("set", tmp_path / "data", sources=local)
    assert (tmp_path / "data" / "set" / "a run.csv").read_text() == "t,q1\n0,1\n"


def test_what_cannot_be_fetched_is_told_and_nothing_is_written(local, tmp_path):
    gone = {"set": Source(local["set"].base, ("none.csv",), "", "", "")}
    with pytest.raises(InputError, match="cannot be fetched"):
        fetch("set", tmp_path / "data", sources=gone)
    with pytest.raises(InputError, match="Did you mean emps"):
        fetch("emp", tmp_path / "data")
    assert not (tmp_path / "data").exists()


def test_without_pooch_the_extra_is_named(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "pooch", None)
    with pytest.raises(InputError, match=r"jaxswarm\[fetch\]"):
        fetch("emps", tmp_path)


def test_addresses_name_a_commit():
    for source in SOURCES.values():
        assert source.base.startswith("https://") and len(source.base.split("/")[5]) == 40
        assert source.licence and source.cite
