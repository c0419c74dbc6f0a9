"""What a result tells of its inputs: files, folders of recordings, and how they were read."""

import hashlib

from jaxswarm.logs import LogChoice, parse_reading
from jaxswarm.provenance import provenance


def test_files_and_folders_have_digests_that_follow_their_content(tmp_path):
    folder = tmp_path / "bag"
    folder.mkdir()
    (folder / "metadata.yaml").write_text("a")
    file = tmp_path / "log.csv"
    file.write_bytes(b"t,q1")
    first = provenance([file, folder], {})["inputs"]
    assert first[0]["sha256"] == hashlib.sha256(b"t,q1").hexdigest()
    (folder / "metadata.yaml").write_text("b")
    second = provenance([file, folder], {})["inputs"]
    assert first[0] == second[0] and first[1]["sha256"] != second[1]["sha256"]


def test_names_and_units_that_the_user_said_are_told(tmp_path):
    file = tmp_path / "log.csv"
    file.write_bytes(b"t,q1")
    (entry,) = provenance([LogChoice(file, parse_reading("q:deg"))], {})["inputs"]
    assert "deg" in entry["read_as"]
