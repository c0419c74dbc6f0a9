"""A log is predicted as of before or of after what began in the middle of a fitted one."""

from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.model import Model
from jaxswarm.identify.predict import predict_log
from jaxswarm.identify.synthetic import Noise, random_links, synthetic_log
from jaxswarm.logs.motion import Filtering
from jaxswarm.robot import rx60

CHANGE = Term("offset_change", 1, values={"tau": 3.0, "t0": 2.0})
ALWAYS = Term("torque_offset", 1, values={"tau0": 3.0})
ARM = rx60().replace(parameters=random_links(rx60(), np.random.default_rng(0)))
MODEL = Model(ARM, (CHANGE,), (0.01,) * 3, Filtering(20.0, 10.0), (1.0,) * 3)


def log_with(*terms):
    return replace(synthetic_log(ARM, terms, 0, duration=4.0, noise=Noise(0.0, 0.0)), notes=())


@pytest.mark.parametrize(
    "terms,said",
    [
        ((), "taken not to have begun: that leaves"),
        ((ALWAYS,), "taken to be there all along: that"),
    ],
)
def test_torque_tells_whether_a_log_is_of_before_or_of_after(terms, said):
    log = log_with(*terms)
    told = predict_log(MODEL, log)
    assert np.abs(told.tau - log.tau)[20:-20, 1].max() < 0.1
    (note,) = told.notes
    assert "offset_change@joint2 began 2 s into a fitted log" in note and said in note


def test_the_fitted_log_is_predicted_as_fitted():
    log = log_with(CHANGE)
    told = predict_log(MODEL, log)
    assert not told.notes and told.model is not None
    assert np.abs(told.tau - log.tau)[20:-20, 1].max() < 0.2


def test_a_log_without_torque_is_taken_to_be_of_after():
    log = log_with()
    told = predict_log(MODEL, replace(log, tau=None))
    assert np.allclose((told.tau - log.tau)[20:-20, 1], 3.0, atol=0.1)
    assert "it has no torque to tell by" in told.notes[0]


def test_a_model_in_which_nothing_begins_says_nothing():
    log = log_with(ALWAYS)
    assert not predict_log(replace(MODEL, terms=(ALWAYS,)), log).notes
