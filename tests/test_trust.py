"""The campaigns of hostile inputs: inputs that repeat, an oracle that tells wrong ends from right ones."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the benchmarks are not installed

from benchmarks.trust import jobs, oracle, targets  # noqa: E402
from benchmarks.trust.fuzz import one  # noqa: E402
from benchmarks.trust.spoilings import SPOILINGS  # noqa: E402
from jaxswarm.errors import InputError  # noqa: E402
from jaxswarm.logs import Log  # noqa: E402

# Inputs that once ended in another way than by a refusal: rows of a result without values, lists nested too
# deep, a velocity of another motion than the position, matrices without a row, a stretch of few samples
# whose stamps are close.
FELL = (
    (346, "compare"),
    (1222, "compare"),
    (3080, "limits"),
    (3960, "CSV"),
    (4413, "model.json"),
    (6889, "NPZ"),
    (20930, "MAT"),
    (22082, "MAT"),
    (25273, "Parquet"),
)


def raising(error):
    def call():
        raise error

    return call


@pytest.mark.parametrize(
    ("call", "kind"),
    [
        (lambda: None, "accepted"),
        (raising(InputError("log.csv: no such file")), "refused"),
        (raising(InputError("log\x1b[31m.csv: no such file")), "refused"),
        (raising(InputError(" ")), "message"),
        (raising(KeyError("x")), "raised"),
        (raising(RecursionError()), "raised"),
    ],
)
def test_the_oracle(call, kind):
    assert oracle.watched(call).kind == kind


def test_what_hangs_is_seen(monkeypatch):
    monkeypatch.setattr(oracle, "SLOWEST", 0.05)

    def forever():
        while True:
            pass

    assert oracle.watched(forever).kind == "hung"


def test_an_input_is_the_same_at_any_time(tmp_path):
    for number in range(len(targets.ORDER)):
        if targets.ORDER[number] in ("MCAP", "MAT", "rosbag"):
            continue  # their writers put the time of writing into the file
        found = []
        for name in ("a", "b"):
            targets.make(number, tmp_path / name)
            files = sorted(p for p in (tmp_path / name).rglob("*") if p.is_file())
            found.append([p.read_bytes() for p in files if p.suffix != ".npz"])
        assert found[0] == found[1]


@pytest.mark.parametrize(("number", "name"), FELL)
def test_inputs_that_fell(tmp_path, number, name):
    _, outcome = one(number, tmp_path / "input", name)
    assert outcome.kind in ("accepted", "refused"), (name, outcome)


@pytest.mark.parametrize("name", SPOILINGS)
def test_a_spoiling_changes_the_log_and_leaves_its_shape(name):
    t = np.arange(2000) * 0.01
    q = np.sin(np.outer(t, [1.0, 1.7, 2.3]))
    log = Log("made", ("a", "b", "c"), t, q, tau=5.0 * q + 0.1)
    spoiled = SPOILINGS[name].spoil(log, 1, np.random.default_rng(0))
    assert spoiled.q.shape[1] == spoiled.tau.shape[1] == 3 and len(spoiled.t) == len(spoiled.q)
    parts = ("t", "q", "dq", "ddq", "tau")
    same = [np.array_equal(getattr(log, p), getattr(spoiled, p)) for p in parts[:2] + parts[4:]]
    assert not all(same) or spoiled.dq is not None or spoiled.ddq is not None


def test_measured_times_are_no_difference_of_bytes(tmp_path):
    digests = []
    for seconds in (1.0, 2.0):
        place = tmp_path / str(seconds) / jobs.OUT
        place.mkdir(parents=True)
        (place / "rx60.json").write_text(f'{{"a": [{{"seconds": {seconds}, "cost": 3}}]}}')
        digests.append(jobs.content(place.parent))
    assert digests[0] == digests[1] and list(digests[0]) == ["rx60.json"]
