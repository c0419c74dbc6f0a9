"""Blocks by which evidence is counted: of phase where a motion repeats itself, of time where it does not."""

import numpy as np
import pytest
from planted import BAND, blank, log_with, small_arm

from jaxswarm.diagnose.folds.blocks import blocks_of
from jaxswarm.identify import estimate
from jaxswarm.identify.estimation.validate import time_blocks
from jaxswarm.logs.coverage import repeats_after
from jaxswarm.logs.motion import prepare


def _fit(log):
    return estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False)


@pytest.fixture(scope="module")
def periodic():
    return _fit(log_with(duration=30.0))


def test_every_period_is_in_every_block(periodic):
    t, block = periodic.regression.t, blocks_of(periodic)
    motion = periodic.motions[0]
    period = repeats_after(motion.t, motion.q)
    assert period is not None and t[-1] > 2.5 * period
    number = ((t - t[0]) / period).astype(int)
    for k in np.unique(block):
        assert set(number[block == k]) >= {0, 1}
        phase = (t[block == k] - t[0]) / period % 1.0
        assert np.ptp(phase) < 1.5 / (block.max() + 1)


def test_an_error_that_repeats_with_the_motion_is_not_learned_in_one_period_and_shown_in_the_next(
    periodic,
):
    """Laws of twenty numbers that have nothing to do with an error, all smooth functions of phase alone."""
    t, motion = periodic.regression.t, periodic.motions[0]
    period = repeats_after(motion.t, motion.q)
    rng = np.random.default_rng(2)
    turns = 2 * np.pi * np.arange(5, 51) * (t[:, None] - t[0]) / period
    waves = np.hstack([np.sin(turns), np.cos(turns)])

    def left(block, error, columns):
        odd, out = block % 2 == 1, np.empty_like(error)
        for train in (odd, ~odd):
            a = np.linalg.lstsq(columns[train], error[train], rcond=None)[0]
            out[~train] = error[~train] - columns[~train] @ a
        return (out**2).mean() / (error**2).mean()

    draws = [waves @ rng.normal(size=(waves.shape[1], 21)) for _ in range(20)]
    by_time, by_phase = (
        np.mean([left(block, one[:, 0], one[:, 1:]) for one in draws])
        for block in (time_blocks(periodic.regression.log, 20), blocks_of(periodic))
    )
    assert by_time < 0.9 and by_phase > 1.0


def test_motion_that_does_not_repeat_is_cut_in_time():
    found = _fit(log_with(duration=8.0))
    assert repeats_after(found.motions[0].t, found.motions[0].q) is None
    block = blocks_of(found)
    assert (np.diff(block) >= 0).all() and block.max() >= 3
