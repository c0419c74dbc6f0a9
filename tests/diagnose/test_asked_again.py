"""Zeros of joints that a check told of a log are asked again outside of what happened in it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jaxswarm.diagnose.asked_again import doubtful, told_again, without_events
from jaxswarm.identify.checks.guesses import ENCODER_ZERO
from jaxswarm.identify.run import told_of
from jaxswarm.identify.synthetic import Noise, synthetic_log
from jaxswarm.logs.finding import Finding
from jaxswarm.logs.motion import Filtering
from jaxswarm.robot.logged import rigid_columns

WRONG = Finding(
    ENCODER_ZERO,
    "the position of joint2 reads 0.23 rad too small",
    "Take it off the positions",
    False,
)
FALSE = WRONG.note
OTHER = "another note"


@pytest.fixture(scope="module")
def log(arm):
    return synthetic_log(arm, (), 3, noise=Noise(2e-5, 0.05), duration=30.0, rate=125.0)


@pytest.fixture(scope="module")
def model(arm):
    return SimpleNamespace(robot=arm, filtering=Filtering(), terms=())


def with_load(log, arm, start):
    """The log with 6 kg on the last link from a time on, which was carried without a motion of its own."""
    load = np.zeros(10 * arm.num_joints)
    load[-10:-6] = 6.0, 0.3, 0.2, 0.6
    still = np.zeros_like(log.q)
    held = rigid_columns(arm, log.q, still, still) @ load
    return replace(log, tau=log.tau + held * (log.t - log.t[0] > start)[:, None])


def test_a_zero_that_only_what_happened_bears_out_is_told_no_more(log, arm, model):
    told = replace(with_load(log, arm, 18.0), notes=(OTHER, FALSE), findings=(WRONG,))
    assert without_events(told, [(18.0, 1e5)], model).notes == (OTHER,)
    assert without_events(told, [], model).notes == (OTHER, FALSE)  # nothing happened
    assert without_events(told, [(0.5, 1e5)], model).notes == (OTHER, FALSE)  # too little is left


def test_a_zero_that_the_rest_of_the_log_shows_is_told_as_it_shows_there(log, arm, model):
    off = replace(with_load(log, arm, 18.0), q=log.q + 0.3 * (np.arange(6) == 1))
    told = without_events(replace(off, notes=(FALSE,), findings=(WRONG,)), [(18.0, 1e5)], model)
    ((note,), (found,)) = told.notes, told.findings
    assert found.note == note and note.startswith(
        "encoder_zero: the position of joint2 reads 0.30 rad too large"
    )


def test_what_happened_in_any_log_is_left_out_of_what_is_told_of_it(log, arm, model):
    law = SimpleNamespace(in_one_log=True)
    grip = SimpleNamespace(law=law, values={"start": 18.0, "end": 1e5, "log": 1})
    model = SimpleNamespace(**{**vars(model), "terms": (grip,)})
    loaded = replace(with_load(log, arm, 18.0), notes=(FALSE,), findings=(WRONG,))
    fitted = [replace(log, notes=(OTHER,)), loaded]
    scored = [replace(loaded, source="test.npz")]
    errors = {"validation": [{"after": {"events": [{"start": 18.0, "end": 31.0}]}}]}
    told = told_again(told_of(fitted, scored), {"error": errors}, doubtful(fitted, scored), model)
    assert [one["what"] for one in told["findings"]] == [OTHER]
    assert [one["notes"] for one in (*told["logs"], *told["validation_logs"])] == [[OTHER], [], []]
