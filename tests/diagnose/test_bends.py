"""What a model takes up by the times at which something in it changes."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, DECLARED, blank, log_with, small_arm

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.folds import bends
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate, model_torque
from jaxswarm.logs.motion import prepare

LATE = 0.01
JUMP = Term("offset_change", 0, values={"tau": 60.0, "t0": 6.0})


@pytest.fixture(scope="module")
def found():
    """A jump of 60 N m in a log whose torque is late, fitted with the jump alone: that is late by as much."""
    log = log_with(JUMP, Term("time_delay", values={"seconds": LATE}))
    told = replace(JUMP, values={"t0": 6.02})
    return estimate(small_arm(), (*blank(DECLARED), told), [prepare(log, BAND)], bounded=False)


def test_slopes_are_what_the_model_does_where_the_change_is_elsewhere(found):
    (slope,) = bends.time_slopes(found)[:, 0].T
    term, others = found.model.terms[-1], found.model.terms[:-1]
    assert 6.0 < term.values["t0"] < 6.0 + 2.0 * LATE

    def torque(shift):
        moved = replace(term, values=term.values | {"t0": term.values["t0"] + shift})
        motion = found.motions[0]
        return motion.decimator.apply(
            model_torque(replace(found.model, terms=(*others, moved)), motion)
        )[:, 0]

    step = 1e-3
    doubted = bends._TIME * (torque(step) - torque(-step)) / (2.0 * step)
    np.testing.assert_allclose(slope, doubted, atol=0.03 * np.abs(doubted).max())


def test_a_model_without_such_times_has_none(found):
    plain = replace(found, model=replace(found.model, terms=found.model.terms[:-1]))
    assert bends.time_slopes(plain).shape == (*found.regression.torque.shape, 0)


def test_a_delay_is_not_told_by_a_jump_that_was_found_where_it_put_it(found, monkeypatch):
    delay = [Term("time_delay")]

    def told():
        (score,) = score_terms(Linearization(found, cross_fit(found)), delay, 0)
        return score.coefficients[0]

    with_times = told()
    monkeypatch.setattr(bends, "time_slopes", lambda found: bends.width_slopes(found)[:, :, :0])
    assert abs(with_times - LATE) < 0.2 * LATE
    assert abs(told() - LATE) > 0.5 * LATE
