"""Dry friction that turns before its velocity is no torque that was read early."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, NOISE, RATE, blank, log_with, small_arm

from jaxswarm.diagnose.decision.evaluate import score_on
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.sharpness import only_friction
from jaxswarm.diagnose.decision.worth import passes
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import synthetic_log
from jaxswarm.logs.motion import prepare

ASKED = 60


def passing_among_all(score) -> bool:
    return passes(score, ASKED, Rules())


def early_log(dry_alone: bool):
    """A log whose dry friction, or all of its torque, is that of the next sample."""
    log = log_with(duration=24.0, motion_seed=5)
    turns = np.tanh(np.gradient(log.q, 1.0 / RATE, axis=0) / 0.02)
    early = np.array([3.0, 1.5]) * turns if dry_alone else log.tau
    return replace(log, tau=log.tau - early + np.roll(early, -1, axis=0))


@pytest.mark.parametrize("dry_alone", [True, False])
def test_a_delay_is_one_of_all_torque(dry_alone):
    motion = prepare(early_log(dry_alone), BAND)
    found = estimate(small_arm(), blank(), [motion], bounded=False)
    crossfit = cross_fit(found)
    (delay,) = score_on(found, [Term("time_delay")], 0)
    assert passes(delay, ASKED, Rules())
    alone = only_friction([delay], found, crossfit, passing_among_all)
    assert bool(alone) == dry_alone


def test_an_arm_without_friction_is_asked_for_a_delay():
    """Nothing was declared, and nothing of friction can be early: diagnose ended in a traceback."""
    late = Term("time_delay", values={"seconds": 0.008})
    log = synthetic_log(
        small_arm(), (late,), 1, noise=NOISE, duration=12.0, rate=RATE, motion_seed=7
    )
    found = estimate(small_arm(), (), [prepare(log, BAND)], bounded=False)
    crossfit = cross_fit(found)
    (delay,) = score_on(found, [Term("time_delay")], 0)
    assert passes(delay, ASKED, Rules())
    assert only_friction([delay], found, crossfit, passing_among_all) == []


def test_columns_of_nothing_take_up_nothing():
    found = estimate(small_arm(), blank(), [prepare(early_log(True), BAND)], bounded=False)
    crossfit = cross_fit(found)
    nothing = np.zeros((*found.regression.torque.shape, 2))
    for known in (False, True):
        beside = crossfit.with_columns((nothing,) * 3, known)
        for fold, same in zip(beside.folds, crossfit.folds, strict=True):
            np.testing.assert_array_equal(fold.residual, same.residual)
