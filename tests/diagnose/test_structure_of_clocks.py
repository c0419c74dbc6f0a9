"""Structure near the noise counts only where the clock of each joint and its sharp rows leave some of it."""

from dataclasses import replace

import numpy as np
from planted import BAND, blank, log_with, small_arm

from jaxswarm.diagnose.decision.material import find_material, is_material
from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import NEAR
from jaxswarm.diagnose.decision.unexplained import find_unexplained
from jaxswarm.diagnose.folds.clocks import clock_slopes
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.estimation.estimate import CLOCKS_APART
from jaxswarm.identify.synthetic import Noise
from jaxswarm.logs.motion import prepare

# What is planted stands out of this noise of the sensor [N m] by less than twice.
QUIET = Noise(2e-5, 0.02)


def fitted(log):
    found = with_motion_noise(estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False))
    return found, cross_fit(found)


def with_early_weight(log, joint: int):
    """The log with the weight on one joint read a sample before everything else."""
    found, _ = fitted(log)
    own = clock_slopes(found)[:, joint, len(log.joints) + joint] / CLOCKS_APART
    tau = np.array(log.tau)
    tau[:, joint] += np.interp(log.t, found.regression.t, own)
    return replace(log, tau=tau)


def seen_and_counted(log, joint: int):
    """Whether structure stands out of the noise of a joint that is near it, and whether it counts."""
    found, folds = fitted(log)
    over = over_noise(found)
    assert over[joint] <= NEAR
    (told,) = find_unexplained(found, folds, 0, [joint])
    return is_material(told, over), any(u.joint == joint for u in find_material(found, folds))


def test_what_the_clock_of_a_joint_leaves_is_no_structure():
    """It followed the speed of the joint before it: 0.7 of what was left, 1.6 times the noise."""
    log = with_early_weight(log_with(noise=QUIET, motion_seed=9), 1)
    assert seen_and_counted(log, 1) == (True, False)


def test_what_a_law_leaves_is_structure_whatever_the_clocks():
    drag = Term("quadratic_drag", 1, values={"c": 0.2})
    assert seen_and_counted(log_with(drag, noise=replace(QUIET, torque=0.05)), 1) == (True, True)
