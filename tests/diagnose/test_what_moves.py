"""``identify`` fits as ``diagnose`` does: without the rows in which dry friction holds joints for moments."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, blank, log_with, small_arm
from test_standing import sticking, truth

import jaxswarm
from jaxswarm.diagnose import diagnose
from jaxswarm.diagnose.selection.what_moves import fit_of_what_moves
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate, model_torque
from jaxswarm.identify.estimation.clock_skew import estimate_with_clocks
from jaxswarm.logs.motion import prepare


def identified(log):
    return estimate_with_clocks(small_arm(), blank(), [prepare(log, BAND)])


def off(found) -> np.ndarray:
    """RMS torque (n,) by which a model is off the true one where the joints of another motion move."""
    motion = prepare(log_with(seed=7, motion_seed=9), BAND)
    error = model_torque(truth(), motion) - model_torque(found.model, motion)
    slow = np.abs(motion.dq) < 0.1 * np.abs(motion.dq).max(axis=0)
    return np.sqrt(np.square(np.where(slow, 0.0, error)).mean(axis=0))


@pytest.mark.parametrize("seed", [0, 3])
def test_what_friction_holds_for_moments_bends_no_fit(seed):
    found = identified(sticking(seed))
    after = fit_of_what_moves(found)
    one, two = off(found), off(after)
    assert (two < 0.8 * one).all() and np.linalg.norm(two) < 0.6 * np.linalg.norm(one)
    assert after is not found


def test_it_is_the_fit_of_a_diagnosis_that_adds_nothing():
    log = sticking(0)
    told = diagnose(small_arm(), blank(), [prepare(log, BAND)])
    assert not told.steps
    after = fit_of_what_moves(identified(log))
    for one, two in zip(after.motions, told.final.motions, strict=True):
        np.testing.assert_array_equal(one.held, two.held)
    np.testing.assert_allclose(after.fit.sigma, told.final.fit.sigma, rtol=0.02)


def test_a_fit_near_its_noise_stays_as_it_is():
    found = identified(log_with())
    assert fit_of_what_moves(found) is found


def test_what_lacks_a_law_keeps_its_rows():
    """What moves is as far from the noise as what hardly does: nothing says that friction holds the joint."""
    spring = Term("joint_spring", 1, values={"k": 25.0, "tau0": 2.0})
    found = estimate(small_arm(), blank(), [prepare(log_with(spring), BAND)])
    assert fit_of_what_moves(found) is found


def test_the_function_says_which_rows_are_not_fitted():
    log = replace(sticking(0), source="sticks.npz")
    told = jaxswarm.identify(log, small_arm(), "viscous_friction,coulomb_friction")
    assert told["held_at_rest"]
