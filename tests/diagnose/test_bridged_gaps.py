"""Where a log has no samples nothing can have happened that anybody could tell."""

from dataclasses import replace

import numpy as np
from planted import BAND, blank, log_with, small_arm

from jaxswarm.diagnose.folds.noise import event_doubt, row_doubt, with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

FIRST, MISSING = 700, 10


def fitted(log):
    return with_motion_noise(estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False))


def test_samples_that_are_missing_are_no_event():
    log = log_with()
    kept = np.ones(len(log.t), bool)
    kept[FIRST : FIRST + MISSING] = False
    parts = {name: getattr(log, name)[kept] for name in ("t", "q", "tau")}
    channels = {name: x[kept] for name, x in log.channels.items()}
    gappy = replace(log, **parts, dq=None, ddq=None, channels=channels)
    found = fitted(gappy)
    (motion,) = found.motions
    assert motion.bridged.sum() == MISSING
    inside = motion.t[motion.bridged]
    rows = (found.regression.t >= inside[0]) & (found.regression.t <= inside[-1])
    assert rows.any()
    timing = cross_fit(found).timing
    assert (timing[rows] < 0.01).all()
    far = np.abs(found.regression.t - inside.mean()) > 1.0
    assert np.median(timing[far]) > 0.5
    # for laws, which all rows tell, nothing changes
    assert (row_doubt(found)[rows] < event_doubt(found)[rows]).all()


def test_a_whole_log_is_bridged_nowhere():
    assert fitted(log_with()).motions[0].bridged is None
