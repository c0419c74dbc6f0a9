"""Fetching: from files and a server of this machine, and one sentence where there is no connection."""

import hashlib
import http.server
import socket
import sys
import threading
from functools import partial

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


def test_a_first_download_is_told_to_be_trusted_and_a_later_one_to_be_the_same(local, tmp_path):
    first = fetch("set", tmp_path / "data", sources=local)
    assert first["first_seen"] == ["a run.csv"]
    assert "1 of 1 files were fetched for the first time" in " ".join(first.lines)
    second = fetch("set", tmp_path / "data", sources=local)
    assert second["first_seen"] == [] and "checksums: the same as in" in " ".join(second.lines)


def test_checksums_of_somebody_else_hold_for_the_first_download(local, tmp_path):
    place = tmp_path / "data" / "set"
    place.mkdir(parents=True)
    (place / "checksums.json").write_text('{"a run.csv": "' + "0" * 64 + '"}')
    with pytest.raises(InputError, match="pinned"):
        fetch("set", tmp_path / "data", sources=local)
    assert not (place / "a run.csv").exists()


class Silent(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *words):
        pass


@pytest.fixture
def served(local, tmp_path, monkeypatch):
    """The same set by HTTP."""
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    handler = partial(Silent, directory=str(tmp_path / "public"))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        base = f"http://127.0.0.1:{server.server_port}/"
        yield {"set": Source(base, ("a run.csv",), "CC0", "Nobody, 2020", "a test")}
        server.shutdown()


def test_by_http_checksums_licence_and_citation_come_along(served, tmp_path):
    told = []
    found = fetch("set", tmp_path / "data", sources=served, progress=told.append)
    path = tmp_path / "data" / "set" / "a run.csv"
    assert found["sha256"] == {"a run.csv": hashlib.sha256(path.read_bytes()).hexdigest()}
    assert "licence: CC0" in repr(found) and "cite: Nobody, 2020" in repr(found)
    assert told[0].endswith("/a%20run.csv")
    fetch("set", tmp_path / "data", sources=served)  # the same file again is no other one
    (tmp_path / "public" / "a run.csv").write_text("t,q1\n0,2\n")
    with pytest.raises(InputError, match="not the file whose SHA-256 is pinned"):
        fetch("set", tmp_path / "data", sources=served)
    assert path.read_text() == "t,q1\n0,1\n"


def test_what_a_server_refuses_is_told_by_its_answer(served, tmp_path):
    gone = {"set": Source(served["set"].base, ("none.csv",), "", "", "")}
    with pytest.raises(InputError, match="the server answers 404"):
        fetch("set", tmp_path / "data", sources=gone)
    assert not (tmp_path / "data").exists()


def test_without_a_connection_the_remedy_is_told(local, tmp_path, monkeypatch):
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    with socket.create_server(("127.0.0.1", 0)) as free:
        closed = f"http://127.0.0.1:{free.getsockname()[1]}/"
    with pytest.raises(InputError, match=r"cannot be fetched \(Connect.*check the connection"):
        fetch("set", tmp_path / "data", sources={"set": Source(closed, ("a.csv",), "", "", "")})
    assert not (tmp_path / "data").exists()


def test_a_file_that_changed_is_refused(local, tmp_path):
    fetch("set", tmp_path / "data", sources=local)
    (tmp_path / "public" / "a run.csv").write_text("t,q1\n0,2\n")
    with pytest.raises(InputError, match="not the file whose SHA-256 is pinned"):
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
