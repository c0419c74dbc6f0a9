"""A fleet from logs to table and page: right rows, nothing done twice, no log ends the others."""

import importlib
import json
import re

import pyarrow.parquet as pq
import pytest
from fleet_logs import COGGING, diagnosed, write_rx60

from jaxswarm.errors import InputError

schedule = importlib.import_module("jaxswarm.fleet.schedule")
CALLS = []


def rows(out, **wanted):
    found = pq.read_table(out / "fleet.parquet").to_pylist()
    return [row for row in found if all(row[k] == v for k, v in wanted.items())]


@pytest.fixture(scope="module")
def fleet(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fleet")
    logs, out = folder / "logs", folder / "out"
    write_rx60(logs / "left" / "2026-01-05.csv", 1)
    write_rx60(logs / "right" / "2026-01-05.csv", 2, COGGING, seconds=11.0)
    (logs / "broken").mkdir()
    (logs / "broken" / "2026-01-05.csv").write_text("t,q1,q2,q3\n0.0,1,2\n")
    return logs, out, diagnosed(logs, out)


def test_every_log_is_a_row_with_its_verdict(fleet):
    _, out, result = fleet
    told = {row["arm"]: row for row in rows(out, row="log")}
    assert {arm: row["verdict"] for arm, row in told.items()} == {
        "broken": "refused",
        "left": "nothing missing",
        "right": "explained",
    }
    assert "2026-01-05.csv" in told["broken"]["reason"]
    assert told["right"]["error_after"] < 0.5 * told["right"]["error_before"]
    assert f"{told['left']['date']:%Y-%m-%d}" == "2026-01-05"
    assert result["verdicts"] == {"refused": 1, "nothing missing": 1, "explained": 1}


def test_the_planted_effect_stands_with_its_arm_joint_and_interval(fleet):
    _, out, _ = fleet
    found = rows(out, row="effect", parameter="n")
    assert [(r["arm"], r["effect"], r["joint"]) for r in found] == [
        ("right", COGGING.effect, "joint1")
    ]
    assert found[0]["lower"] < 22.0 + 0.1 and found[0]["upper"] > 22.0 - 0.1


def test_every_joint_has_its_errors_and_every_parameter_its_interval(fleet):
    _, out, _ = fleet
    joints = rows(out, row="joint", arm="left")
    assert [r["joint"] for r in joints] == ["joint1", "joint2", "joint3"]
    assert all(0.3 < r["residual_over_noise"] < 2.0 for r in joints)
    friction = rows(out, row="parameter", arm="left", parameter="b_joint2")[0]
    assert friction["joint"] == "joint2" and friction["lower"] < 2.0 < friction["upper"]


def test_the_arm_that_lacks_something_stands_first_on_a_page_that_needs_nothing_else(fleet):
    _, out, result = fleet
    assert result["arms"][0]["name"] == "right"
    page = (out / "fleet.html").read_text()
    assert page.index(">right<") < page.index(">left<")
    assert "broken/2026-01-05.csv: refused" in page
    assert not re.search(r'(src|href)="(?!data:)', page) and "<script" not in page


def test_single_results_are_those_of_the_command_for_one_log(fleet):
    logs, out, _ = fleet
    from fleet_logs import DECLARED

    from jaxswarm.tasks.diagnosis import diagnose

    alone = diagnose([logs / "right" / "2026-01-05.csv"], "rx60", DECLARED)
    kept = next(out.glob("logs/right*/diagnosis.json"))
    assert json.loads(kept.read_text())["effects"] == json.loads(json.dumps(alone["effects"]))


def test_a_log_of_another_length_compiles_next_to_nothing(fleet, tmp_path):
    import jax.monitoring
    from fleet_logs import DECLARED, arm

    from jaxswarm.fleet.one_log import Settings, examine

    compiled = []
    jax.monitoring.register_event_duration_secs_listener(
        lambda event, _, **more: compiled.append(event) if "backend_compile" in event else None
    )
    for seconds in (10.3, 10.7):
        compiled.clear()
        write_rx60(tmp_path / "log.csv", 3, seconds=seconds)
        assert "result" in examine(str(tmp_path / "log.csv"), Settings(arm(), DECLARED))
    # Numbers of single values may meet a program of their own; what has the length of a log may not.
    assert len(compiled) <= 3


def counted(address, settings):
    CALLS.append(address)
    return {"stamp": importlib.import_module("jaxswarm.fleet.sources").stamp(address), **RESULT}


RESULT = {"unused": "refused", "reason": "a reason"}


@pytest.fixture
def counting(monkeypatch):
    CALLS.clear()
    monkeypatch.setattr(schedule, "examine", counted)


def test_what_is_done_is_not_done_again_unless_the_log_or_the_question_changes(fleet, counting):
    logs, out, first = fleet
    again = diagnosed(logs, out)
    assert CALLS == [] and again.content == first.content
    with (logs / "broken" / "2026-01-05.csv").open("a") as file:
        file.write("0.1,1,2,3\n")
    diagnosed(logs, out)
    assert [path.rsplit("/", 2)[1] for path in CALLS] == ["broken"]
    diagnosed(logs, out.with_name("other"), seed=1)
    diagnosed(logs, out.with_name("other"), seed=2)
    assert len(CALLS) == 1 + 3 + 3


def many(folder, count):
    folder.mkdir()
    for k in range(count):
        (folder / f"arm{k}_2026-01-05.csv").write_text(f"t,q1\n{k},0\n")
    return folder


def test_an_interrupted_fleet_goes_on_where_it_was(tmp_path, counting, monkeypatch):
    logs, out = many(tmp_path / "logs", 4), tmp_path / "out"
    store = importlib.import_module("jaxswarm.fleet.store").Store
    keep, kept = store.keep, []

    def until_two(self, source, answer):
        if len(kept) == 2:
            raise KeyboardInterrupt
        kept.append(source.path)
        keep(self, source, answer)

    monkeypatch.setattr(store, "keep", until_two)
    with pytest.raises(KeyboardInterrupt):
        diagnosed(logs, out)
    assert not (out / "fleet.parquet").exists()
    monkeypatch.setattr(store, "keep", keep)
    CALLS.clear()
    diagnosed(logs, out)
    assert len(CALLS) == 2 and not {c.rsplit("/", 1)[1] for c in CALLS} & set(kept)
    assert len(rows(out, row="log")) == 4


def one_fails(address, settings):
    CALLS.append(address)
    if "arm2" in address:
        raise RuntimeError("the worker has a bad day")
    return counted(address, settings)


def test_a_task_that_fails_is_a_row_and_is_tried_again(tmp_path, monkeypatch):
    logs, out = many(tmp_path / "logs", 3), tmp_path / "out"
    CALLS.clear()
    monkeypatch.setattr(schedule, "examine", one_fails)
    diagnosed(logs, out)
    assert [r["reason"] for r in rows(out, row="log", arm="arm2")] == [
        "RuntimeError: the worker has a bad day"
    ]
    monkeypatch.setattr(schedule, "examine", counted)
    CALLS.clear()
    diagnosed(logs, out)
    assert len(CALLS) == 1 and rows(out, row="log", arm="arm2")[0]["reason"] == "a reason"


def test_results_among_the_logs_are_refused(tmp_path):
    logs = many(tmp_path / "logs", 1)
    with pytest.raises(InputError, match="apart"):
        diagnosed(logs, logs / "out")
    assert not (logs / "out").exists()
