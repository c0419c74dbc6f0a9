"""Results are written whole or not at all, replaced as a set, and never over what is not ours."""

import json
import os
import resource
import subprocess
import sys

import pytest

from jaxswarm.errors import InputError, Notice
from jaxswarm.outputs import check_file, check_folder, file_name, write_files, write_results


def names(folder):
    return sorted(path.name for path in folder.iterdir() if not path.name.startswith("."))


def test_a_full_disk_leaves_the_folder_as_it_was(tmp_path):
    (tmp_path / "a.json").write_text("before")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with pytest.raises(InputError, match="cannot write"):
            write_results(tmp_path, {"a.json": "after", "b.json": "x" * 2000})
        with pytest.raises(InputError, match="cannot write"):
            write_results(tmp_path / "new" / "deep", {"a.json": "x", "b.json": "x" * 2000})
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]
    assert (tmp_path / "a.json").read_text() == "before"


def test_a_failing_writer_leaves_nothing(tmp_path):
    def fail(path):
        path.write_text("half")
        raise OSError(28, "No space left on device")

    with pytest.raises(InputError, match="No space left"):
        write_results(tmp_path / "out", {"model.json": "{}", "torque.png": fail})
    assert list(tmp_path.iterdir()) == []


def test_the_files_of_an_earlier_run_are_replaced_as_a_set(tmp_path):
    write_results(tmp_path, {"model.json": "1", "effect_1.png": b"1", "effect_2.png": b"2"})
    write_results(tmp_path, {"trajectory.csv": "t"})
    (tmp_path / "effect_9.png").write_bytes(b"the user's own")
    (tmp_path / "effect_2.png").write_bytes(b"edited by the user")
    with pytest.warns(Notice, match=r"removed, made by an earlier run: effect_1\.png$"):
        write_results(tmp_path, {"model.json": "2"})
    assert names(tmp_path) == ["effect_2.png", "effect_9.png", "model.json", "trajectory.csv"]
    assert (tmp_path / "model.json").read_text() == "2"


def test_overwriting_a_file_that_is_not_ours_is_told(tmp_path, recwarn):
    write_results(tmp_path, {"model.json": "1"})
    write_results(tmp_path, {"model.json": "2"})
    assert not recwarn.list
    (tmp_path / "model.json").write_text("the user's own")
    with pytest.warns(Notice, match=r"overwritten.*model\.json"):
        write_results(tmp_path, {"model.json": "3"})


def test_a_manifest_never_leads_out_of_the_folder(tmp_path):
    out = tmp_path / "out"
    (tmp_path / "victim").write_text("kept")
    write_results(out, {"model.json": "1"})
    manifest = json.loads((out / ".jaxswarm.json").read_text())
    manifest["sets"][0]["../victim"] = next(iter(manifest["sets"][0].values()))
    (out / ".jaxswarm.json").write_text(json.dumps(manifest))
    (tmp_path / "victim").write_text("1")  # the same digest as the manifest claims
    write_results(out, {"model.json": "2"})
    assert (tmp_path / "victim").exists()


def test_unfinished_files_of_dead_processes_are_removed(tmp_path):
    code = (
        "import os, sys; from pathlib import Path; from jaxswarm.outputs import write_files\n"
        "write_files(Path(sys.argv[1]), {'a.json': lambda path: os._exit(9)})"
    )
    assert subprocess.run([sys.executable, "-c", code, str(tmp_path)], check=False).returncode == 9
    (orphan,) = tmp_path.iterdir()
    foreign = tmp_path / ".jaxswarm-part-another.machine-1-x.json"
    foreign.write_text("")
    write_files(tmp_path, {"b.json": "{}"})
    assert not orphan.exists()
    assert foreign.exists() and (tmp_path / "b.json").exists()


def test_names_that_no_file_can_have(tmp_path):
    files = {"unexplained_a/b.png": b"1", "unexplained_a:b.png": b"2", f"{'ä' * 300}.png": b"3"}
    done = write_results(tmp_path, files)
    assert len({path.name for path in done}) == 3
    assert sorted(path.read_bytes() for path in done) == [b"1", b"2", b"3"]
    assert all(path.parent == tmp_path for path in done)
    assert file_name("../../etc/passwd.png") == ".._.._etc_passwd.png"


@pytest.mark.parametrize("place", ["{}", "{}/deeper", "deeper/{}"])
def test_a_name_too_long_is_refused_before_the_work(tmp_path, place):
    long = place.format("n" * 300)
    with pytest.raises(InputError, match="too long"):
        check_folder(tmp_path / long)
    with pytest.raises(InputError, match="too long"):
        check_file(tmp_path / long)
    assert list(tmp_path.iterdir()) == []


def test_texts_that_are_no_unicode_become_escapes(tmp_path):
    name = os.fsdecode(b"log\xff.csv")
    from jaxswarm.outputs import to_json

    (path, page) = write_files(tmp_path, {"a.json": to_json({"log": name}), "b.html": name})
    assert json.loads(path.read_bytes()) == {"log": name}
    assert page.read_text(encoding="utf-8") == "log\\udcff.csv"
