"""An interrupted diagnosis goes on where it was, and ends as one that was never interrupted."""

import json
import sys

import numpy as np
import pytest

from jaxswarm.diagnose.candidates import propose
from jaxswarm.diagnose.candidates.journal import FILE, Journal, fingerprint
from jaxswarm.diagnose.run import diagnose_files
from jaxswarm.effects.term import Term
from jaxswarm.identify.synthetic import demo_case, synthetic_log
from jaxswarm.logs.motion import Filtering, prepare
from jaxswarm.robot import rx60

TERM = Term("stribeck_friction", 1)
FOUND = {TERM: [{"vs": 0.1 + 0.2, "delta": np.float64(1) / 3}] * 3}


def test_values_come_back_to_the_last_bit(tmp_path):
    journal = Journal(tmp_path, "a")
    assert journal.recall(0, TERM) is None
    journal.keep(3, FOUND)
    again = Journal(tmp_path, "a")
    assert again.recall(3, TERM) == FOUND[TERM]
    assert again.recall(2, TERM) is None and again.recall(3, Term("stribeck_friction", 0)) is None
    again.close()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("content", ["", "{", "[]", '{"fingerprint": "b", "rounds": {}}'])
def test_another_diagnosis_or_a_broken_file_is_not_gone_on_from(tmp_path, content):
    Journal(tmp_path, "a").keep(0, FOUND)
    if content:
        (tmp_path / FILE).write_text(content)
    assert Journal(tmp_path, "a" if content else "b").recall(0, TERM) is None


@pytest.mark.parametrize("change", ["another value", "a list", "digits lost"])
def test_what_was_changed_since_it_was_written_is_not_gone_on_from(tmp_path, change):
    Journal(tmp_path, "a").keep(0, FOUND)
    text = (tmp_path / FILE).read_text()
    listed = json.dumps({**json.loads(text), "rounds": [json.loads(text)["rounds"]]})
    spoiled = {
        "another value": text.replace('"vs": 0.3', '"vs": 0.8'),
        "a list": listed,
        "digits lost": text.replace("0004", ""),
    }
    (tmp_path / FILE).write_text(spoiled[change])
    assert (tmp_path / FILE).read_text() != text
    assert Journal(tmp_path, "a").recall(0, TERM) is None


def test_fingerprint_knows_logs_and_options():
    arm, declared, _ = demo_case(rx60(), 3)
    band = Filtering(20.0, 10.0)
    motions = [
        prepare(synthetic_log(arm, declared, seed, duration=4.0, rate=125.0), band)
        for seed in (1, 2)
    ]
    prints = {
        fingerprint(rx60(), motions, 0),
        fingerprint(rx60(), motions, 1),
        fingerprint(rx60(), motions[:1], 0),
        fingerprint(arm, motions, 0),
    }
    assert len(prints) == 4
    assert fingerprint(rx60(), motions, 0) in prints


def test_interrupted_diagnosis_goes_on(tmp_path, monkeypatch):
    arm, declared, hidden = demo_case(rx60(), 3)
    log = synthetic_log(arm, (*declared, *hidden), 3, duration=10.0, rate=125.0)
    path = tmp_path / "arm.npz"
    np.savez(path, t=log.t, q=log.q, tau=log.tau, joints=np.array(log.joints))
    declare = "viscous_friction,coulomb_friction"
    searched, plain = [], propose.searching
    monkeypatch.setattr(propose, "searching", lambda *a: searched.append(1) or plain(*a))

    def stop(text):
        if text.startswith("round 2"):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        diagnose_files([path], "rx60", declare, tmp_path / "out", progress=stop)
    assert [p.name for p in (tmp_path / "out").iterdir()] == [FILE]
    assert len(searched) == 1
    diagnose_files([path], "rx60", declare, tmp_path / "out")
    gone_on = len(searched) - 1
    diagnose_files([path], "rx60", declare, tmp_path / "whole")
    assert len(searched) - 1 - gone_on == gone_on + 1
    one, other = (
        json.loads((tmp_path / d / "diagnosis.json").read_text()) for d in ("out", "whole")
    )
    assert one == other and len(one["effects"]) == 1
    assert not (tmp_path / "out" / FILE).exists()


def test_the_command_says_how_to_go_on(tmp_path, monkeypatch, capsys):
    from jaxswarm import cli
    from jaxswarm.diagnose import run

    def stop(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(run, "diagnose_files", stop)
    arguments = ["jaxswarm", "diagnose", "log.csv", "--robot", "rx60", "--out", str(tmp_path / "o")]
    monkeypatch.setattr(sys, "argv", arguments)
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 130
    assert "same command" in capsys.readouterr().err
