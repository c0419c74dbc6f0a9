"""Logs are found in folders, by globs and at addresses; arm and date come from the path by one rule."""

from datetime import datetime

import fsspec
import pytest
from fleet_logs import diagnosed
from slide import slide_log

from jaxswarm.errors import InputError
from jaxswarm.fleet.naming import arm_and_date, read_pattern
from jaxswarm.fleet.sources import at_hand, find_logs, stamp


@pytest.mark.parametrize(
    ("path", "arm", "date"),
    [
        ("cell7/2026-01-31.csv", "cell7", datetime(2026, 1, 31)),
        ("cell7/2026/01/run_20260131T0930.mcap", "cell7", datetime(2026, 1, 31, 9, 30)),
        ("left_2026-01-31_09-30-15.npz", "left", datetime(2026, 1, 31, 9, 30, 15)),
        ("left-20260131.csv", "left", datetime(2026, 1, 31)),
        ("arm12.csv", "arm12", None),
        ("arm12_99999999.csv", "arm12", None),
        ("2026-01-31.csv", "2026-01-31", datetime(2026, 1, 31)),
    ],
)
def test_arm_and_date_of_a_path(path, arm, date):
    assert arm_and_date(path) == (arm, date)


def test_a_pattern_takes_the_place_of_the_rule():
    pattern = read_pattern(r"site\d/(?P<arm>\w+?)-(?P<date>\d{8})")
    assert arm_and_date("site3/kr3-20260131.csv", pattern) == ("kr3", datetime(2026, 1, 31))
    with pytest.raises(InputError, match="does not match"):
        arm_and_date("kr3.csv", pattern)


@pytest.mark.parametrize("pattern", ["(", r"(?P<name>x)"])
def test_patterns_that_are_none(pattern):
    with pytest.raises(InputError, match="--arm-pattern"):
        read_pattern(pattern)


def test_folders_and_globs(tmp_path):
    for name in ("a/2026-01-01.csv", "a/notes.txt", "b/deep/2026-01-02.NPZ", "c_2026-01-03.csv"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("x")
    assert [s.arm for s in find_logs(str(tmp_path))] == ["a", "b", "c"]
    assert [s.path for s in find_logs(f"{tmp_path}/*/*.csv")] == ["a/2026-01-01.csv"]
    assert [s.arm for s in find_logs(f"{tmp_path}/c_*.csv")] == ["c"]
    names = [s.name for s in find_logs(str(tmp_path))]
    assert len(set(names)) == 3 and names[0].startswith("a_2026-01-01-")


@pytest.mark.parametrize("where", ["nowhere", "nowhere/*.csv", "nothing://x"])
def test_places_without_logs_are_told(tmp_path, monkeypatch, where):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=where.split("/")[0]):
        find_logs(where)


def test_a_fleet_in_a_store_elsewhere(tmp_path):
    store = fsspec.filesystem("memory")
    store.pipe("/fleet/one_2026-01-05.csv", "\n".join(slide_log(400)).encode())
    store.pipe("/fleet/two_2026-01-06.csv", b"t,q_slide\n")
    try:
        sources = find_logs("memory://fleet")
        assert [s.address for s in sources] == [
            "memory:///fleet/one_2026-01-05.csv",
            "memory:///fleet/two_2026-01-06.csv",
        ]
        before = stamp(sources[0].address)
        assert before == stamp(sources[0].address)
        with at_hand(sources[0].address) as path:
            assert path.read_text().startswith("t,q_slide,tau_slide")
        assert not path.exists()
        result = diagnosed("memory://fleet", tmp_path / "out", robot="emps")
        verdicts = {arm["name"]: arm["verdict"] for arm in result["arms"]}
        assert verdicts == {"one": "nothing missing", "two": "refused"}
        store.pipe("/fleet/one_2026-01-05.csv", b"t,q_slide\n0,1\n")
        assert stamp(sources[0].address) != before
    finally:
        store.rm("/fleet", recursive=True)
