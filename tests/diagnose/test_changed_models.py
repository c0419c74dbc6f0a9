"""Candidates seen with other linear parameters of a model: loads at once, torques where they are asked for."""

import importlib
from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, blank, log_with, small_arm

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_on
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.forward.model import linear_values
from jaxswarm.logs.motion import prepare

module = importlib.import_module("jaxswarm.diagnose.candidates.linearization")


@pytest.fixture(scope="module")
def found():
    hidden = Term("load_dependent_friction", 0, values={"mu": 0.2, "inertial": 1.0})
    return estimate(small_arm(), blank(), [prepare(log_with(hidden), BAND)])


def test_the_torque_is_that_of_the_model_that_is_seen(found):
    lin = Linearization(found, cross_fit(found))
    before = lin.outputs[0]
    change = 0.1 * linear_values(found.model)
    other = lin.changed_by(change)
    np.testing.assert_allclose(other.outputs[0], 1.1 * before, atol=1e-9 * np.abs(before).max())
    np.testing.assert_allclose(lin.outputs[0], before)
    np.testing.assert_allclose(other.loads[0].full, 1.1 * lin.loads[0].full)


def test_a_law_of_the_load_asks_for_no_torque_of_the_model(found, monkeypatch):
    """It was made anew for each of up to 54 models that such a law is tried with."""
    monkeypatch.setattr(module, "torque_along", None)
    (score,) = score_on(found, [Term("load_dependent_friction", 0)], 0)
    assert score.gain > 0.3


@pytest.mark.parametrize("clock", [(), (Term("time_delay", None, values={"seconds": 0.003}),)])
def test_the_torque_of_a_joint_is_that_of_the_model_without_the_laws_of_others(found, clock):
    """A drive that distorts its torque was tried with up to 54 models, each with all laws of all joints."""
    told = replace(found, model=replace(found.model, terms=(*found.model.terms, *clock)))
    lin = Linearization(told, cross_fit(found))
    other = lin.changed_by(0.1 * linear_values(told.model))
    own = other.output_of(0, 1)
    assert all(t.joint in (1, None) for t in other.seen.on_joint(1).terms)
    np.testing.assert_array_equal(own, other.outputs[0][:, 1])
