"""``python -m benchmarks`` knows every benchmark; two result files are compared row by row."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from jaxswarm.errors import InputError

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks"
sys.path.insert(0, str(FOLDER.parent))  # the benchmarks are not installed

from benchmarks import throughput, throughput_rivals, timing  # noqa: E402
from benchmarks.__main__ import benchmarks, listing, main  # noqa: E402
from benchmarks.compare import compare  # noqa: E402


def test_every_module_that_runs_is_listed_with_needs_and_time():
    found = {one.name: one for one in benchmarks()}
    runs = {p.stem for p in FOLDER.glob("[!_]*.py") if "__main__" in p.read_text()}
    runs |= {p.parent.name for p in FOLDER.glob("*/__main__.py")}
    assert set(found) == runs and {"throughput", "diagnosis", "trust"} <= runs
    for one in found.values():
        assert one.what.endswith((".", "?")) and one.call.startswith("python -m benchmarks.")
        assert one.takes != "not stated" and f"{one.name}: {one.what}" in listing([one])


def test_what_is_missing_is_said(tmp_path, monkeypatch):
    (tmp_path / "one.py").write_text(
        '"""Measures one.\n\n    python -m benchmarks.one [--fast]\n"""\n'
        'NEEDS = ("json", "no_such_package", "data")\nTAKES = "a minute"\n'
        'if __name__ == "__main__":\n    pass\n'
    )
    (tmp_path / "part.py").write_text('"""Is imported by one."""\n')
    monkeypatch.setenv("JAXSWARM_DATA", str(tmp_path))
    text = listing(benchmarks(tmp_path))
    assert "one: Measures one." in text and "python -m benchmarks.one [--fast]" in text
    assert "json, no_such_package (missing), data (missing); takes a minute" in text
    assert "part" not in text


def write(path, rows):
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    return path


ROWS = [
    {"name": name, "runs": runs, "dtype": "float32", "us": 10.0 * runs, "machine": {"cpu": "x"}}
    for name in ("ours", "theirs")
    for runs in (1, 10)
]


def test_ratios_of_rows_that_belong_together(tmp_path):
    slower = [row | {"us": row["us"] * (2 if row["runs"] == 1 else 8)} for row in ROWS]
    a, b = write(tmp_path / "a", ROWS), write(tmp_path / "b", slower[::-1])
    text = compare(a, b)
    assert re.findall(r"us +10 +20 +2\.000", text) and re.findall(r"us +100 +800 +8\.000", text)
    assert re.search(r"us +4\.000 +\[2, 8\] of 4", text)  # the geometric mean of 2 and 8
    assert "Other machines" not in text and "only in" not in text


def test_rows_and_machines_that_differ_are_named(tmp_path):
    other = [row | {"machine": {"cpu": "y"}} for row in ROWS[:3]]
    text = compare(write(tmp_path / "a", ROWS), write(tmp_path / "b", other))
    assert "Other machines" in text and "only in A: theirs float32 10" in text


def test_lists_and_records_are_measured(tmp_path):
    rows = [{"name": "x", "errors": [1.0, 5.0, 2.0], "time": {"first": 4}}]
    after = [{"name": "x", "errors": [3.0, 4.0, 9.0], "time": {"first": 0}}]
    text = compare(write(tmp_path / "a", rows), write(tmp_path / "b", after))
    assert re.search(r"errors, median +2 +4 +2\.000", text)
    assert re.search(r"time.first +4 +0 +0\.000", text)


def test_rows_may_be_known_by_a_list(tmp_path):
    rows = [{"joints": [1, 2], "s": 1.0}, {"joints": [3], "s": 2.0}]
    path = write(tmp_path / "a", rows)
    assert "[1, 2]" in compare(path, path, ["joints"])


@pytest.mark.parametrize(
    "content, by, message",
    [
        ("", None, "is empty"),
        ("{\n", None, "line 1 is no JSON"),
        ("3\n", None, "expected an object"),
        ('{"name": "else", "us": 1}\n', None, "no row in common by name"),
        ('{"name": "ours", "us": 1}\n' * 2, ["name"], "two rows with"),
        ('{"name": "ours", "us": 1}\n', ["color"], "no field 'color'"),
    ],
)
def test_bad_files_are_one_message(tmp_path, capsys, content, by, message):
    a = write(tmp_path / "a", [{"name": "ours", "us": 1.0}])
    b = tmp_path / "b"
    b.write_text(content)
    with pytest.raises(InputError, match=message):
        compare(b, a, by) if by else compare(a, b)
    with pytest.raises(SystemExit) as ended:
        main(["--compare", str(b), str(tmp_path / "none")])
    assert ended.value.code == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_a_cell_that_fails_costs_no_other_cell(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(timing, "RESULTS", tmp_path)
    row = dict(algorithm="PSO", num_particles=5, dims=2, runs=1, dtype="float32", name="jaxswarm")
    row |= dict(us_per_update=1.0, times_jaxswarm=1.0, core_times_jaxswarm=1.0, compile_s=0.1)

    def rows_of(algorithm):
        if algorithm == "DE":
            raise subprocess.CalledProcessError(1, "measure", stderr="no memory")
        return [row | {"algorithm": algorithm}]

    assert throughput.in_turn([("PSO",), ("DE",), ("CMA-ES",)], rows_of) == 1
    written = (tmp_path / "throughput.jsonl").read_text().splitlines()
    assert [json.loads(line)["algorithm"] for line in written] == ["PSO", "CMA-ES"]
    assert "DE failed: no memory" in capsys.readouterr().out


def test_peers_that_are_not_installed_are_left_out(monkeypatch):
    for name in ("evosax.algorithms", "pyswarms.single", "pygmo"):
        monkeypatch.setitem(sys.modules, name, None)
    assert throughput_rivals.peers("PSO", 5, 2, 1, 3) == {}
