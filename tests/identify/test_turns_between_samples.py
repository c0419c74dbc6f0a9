"""A sign that turns between two samples of a fast reversal."""

from dataclasses import replace

import numpy as np
import scipy
from small_problems import make_motion, planar_arm

from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.forward.direction import direction
from jaxswarm.logs.filtering import design_decimator
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import prepare

LAWS = tuple(Term(e, j) for e in ("coulomb_friction", "viscous_friction") for j in range(2))
WIDTH, PARTS = 0.05, 21


def widths(driven):
    """Fitted widths of joints that pass zero within a tenth of a sample, which half of the torque takes."""
    motion = make_motion(planar_arm(), length=3000, noise=0.2)
    speed = scipy.interpolate.CubicSpline(motion.t, motion.dq, axis=0)
    about = 0.01 * (np.arange(PARTS) / (PARTS - 1) - 0.5)
    mean = np.mean([np.tanh(speed(motion.t + late) / WIDTH) for late in about], axis=0)
    tau = motion.tau + mean + np.tanh(motion.dq / WIDTH) + 0.5 * motion.dq
    decimator = design_decimator(motion.rate, motion.torque_cutoff)
    motion = replace(motion, tau=tau, decimator=decimator, driven=driven)
    return np.array(estimate(planar_arm(), LAWS, [motion]).model.width)


def test_a_width_is_not_told_too_wide_by_a_sign_that_turns_between_samples():
    """Read at the samples alone it came out three times as wide, and erred at rest."""
    assert (widths(False) > 2.0 * WIDTH).all()
    np.testing.assert_allclose(widths(True), WIDTH, rtol=0.1)


def test_a_slow_sign_and_a_made_motion_are_read_at_their_samples():
    dq = np.linspace(-1.0, 1.0, 41)
    np.testing.assert_array_equal(direction(dq, 0.06, True), np.tanh(dq / 0.06))
    np.testing.assert_array_equal(direction(dq, 1e-3), np.tanh(dq / 1e-3))


def test_a_sharp_sign_is_half_of_that_at_the_sample_and_half_of_its_mean():
    """A quarter of the way from one sample to the next the speed is zero."""
    np.testing.assert_allclose(
        direction(np.array([-9.0, -5.0, -1.0, 3.0, 7.0]), 1e-4, True), [-1.0, -1.0, -0.75, 1.0, 1.0],
        atol=1e-3,
    )  # fmt: skip


def test_the_motion_of_a_log_is_driven():
    t = np.arange(400) * 0.01
    q = np.sin(t)[:, None]
    assert prepare(Log("made", ("a",), t, q, None, None, 3.0 * q)).driven
