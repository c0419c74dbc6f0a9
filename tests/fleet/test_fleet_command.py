"""``diagnose --fleet`` on the command line: what is refused, with one message and nothing written."""

import importlib
import json

import pytest
from slide import assert_refused, run, slide_log


def fleet(out, *more, logs="logs"):
    return run("diagnose", "--fleet", logs, "--robot", "emps", "--out", out, *more)


def test_without_the_extra_one_message_says_how_to_get_it(tmp_path, monkeypatch):
    extra = importlib.import_module("jaxswarm.fleet.extra")
    monkeypatch.setattr(extra, "find_spec", lambda name: None if name == "distributed" else name)
    result = fleet(tmp_path / "out")
    assert_refused(result, "distributed", "pip install 'jaxswarm[fleet]'")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("more", "word"),
    [
        (("log.csv",), "log.csv"),
        (("--validation", "other.csv"), "--validation"),
        (("--against", "sisters"), "sisters"),
        (("--arm-pattern", "x"), "--arm-pattern"),
        (("--scheduler", "tcp://localhost:1", "--workers", 2), "--workers"),
        (("--declare", "vicsous_friction"), "viscous_friction"),
        (("--model", "model.json", "--declare", "none"), "exclude"),
        ((), "no such folder"),
    ],
)
def test_bad_options_are_refused(tmp_path, more, word):
    assert_refused(fleet(tmp_path / "out", *more, logs=tmp_path / "logs"), word)
    assert not (tmp_path / "out").exists()


def test_a_scheduler_that_does_not_answer_is_told(tmp_path, monkeypatch):
    schedule = importlib.import_module("jaxswarm.fleet.schedule")
    monkeypatch.setattr(schedule, "_PATIENCE", 0.5)
    (tmp_path / "a_2026-01-05.csv").write_text("t,q1\n0,0\n")
    result = fleet(
        tmp_path / "out" / "x", "--scheduler", "tcp://localhost:9", logs=f"{tmp_path}/*.csv"
    )
    assert_refused(result, "tcp://localhost:9")


def test_workers_that_cannot_be_started_are_told(tmp_path, monkeypatch):
    def fails(**options):
        raise RuntimeError("Nanny failed to start.")

    monkeypatch.setattr("distributed.LocalCluster", fails)
    (tmp_path / "a_2026-01-05.csv").write_text("t,q1\n0,0\n")
    result = fleet(tmp_path / "out", "--workers", 3, logs=f"{tmp_path}/*.csv")
    assert_refused(result, "--workers 3", "Nanny failed to start", "__main__")


@pytest.mark.parametrize("options", [("--against", "fleet"), ("--workers", 2), ("--adaptive",)])
def test_options_of_a_fleet_need_one(tmp_path, options):
    result = run("diagnose", "a.csv", "--robot", "emps", "--out", tmp_path / "out", *options)
    assert_refused(result, options[0], "--fleet")


def test_no_logs_at_all_is_told():
    assert_refused(run("diagnose", "--robot", "emps", "--out", "out"), "--fleet")


def test_a_worker_process_of_its_own_reads_logs_as_is_said(tmp_path):
    (tmp_path / "logs").mkdir()
    rows = ["Time,pos [cm],force", *slide_log(400)[1:]]
    (tmp_path / "logs" / "one_2026-01-05.csv").write_text("\n".join(rows))
    code, out, err = fleet(
        tmp_path / "out", "--declare", "viscous_friction,coulomb_friction", "--workers", 1, "--json",
        "--columns", "t=Time,q_slide=pos [cm]:m,tau_slide=force", logs=tmp_path / "logs",
    )  # fmt: skip
    assert code == 0, err
    assert json.loads(out)["verdicts"] == {"nothing missing": 1}
    assert (tmp_path / "out" / "fleet.html").exists()
