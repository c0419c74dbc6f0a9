"""Noise of the torque that is stronger the slower it is, told from what a law leaves above the band."""

from dataclasses import replace

import numpy as np
import scipy
from planted import BAND, DECLARED, blank, small_arm

from jaxswarm.diagnose.decision.remainder import remainders
from jaxswarm.diagnose.folds.noise import noise_of, with_motion_noise
from jaxswarm.diagnose.folds.steady import steady_power
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import Noise, synthetic_log
from jaxswarm.logs.motion import prepare

RATE, CUTOFF, SIZE = 250.0, 8.0, 1.0


def noise(seed=0, alike=0.0, length=6000):
    drawn = np.random.default_rng(seed).normal(size=(length, 1))
    size = SIZE * np.sqrt(1.0 - alike**2)
    return scipy.signal.lfilter([size], [1.0, -alike], drawn, axis=0)


def of_white(left):
    """Power over that of white noise of the same size."""
    return steady_power(left, RATE, CUTOFF) / (SIZE**2 * CUTOFF / (0.5 * RATE))


def test_white_noise_has_its_power():
    got = np.array([of_white(noise(seed)) for seed in range(40)])
    assert abs(got.mean() - 1.0) < 0.05
    assert got.std() < 0.25


def test_what_comes_in_bursts_or_in_a_line_is_not_taken_for_noise():
    t = np.arange(6000) / RATE
    burst = np.where((t % 4.0 < 0.7), 4.0, 0.0) * np.sin(2 * np.pi * 17.0 * t + 40.0 * t**2)
    line = np.sin(2 * np.pi * 16.0 * t)
    plain = of_white(noise())
    for more, most in ((burst, 1.5), (line, 2.5)):
        left = noise() + more[:, None]
        assert of_white(left) < most * plain


def test_too_short_or_too_slow_a_log_tells_nothing():
    assert steady_power(noise(length=400), RATE, CUTOFF) == 0.0
    assert steady_power(noise(), RATE, 40.0) == 0.0


def test_a_clean_log_whose_noise_has_memory_is_near_its_noise():
    log = synthetic_log(small_arm(), DECLARED, 1, noise=Noise(2e-5, 0.0), duration=24.0, rate=RATE)
    slow = 0.1 * np.hstack([noise(seed, 0.6, len(log.t)) for seed in (1, 2)])
    log = replace(log, tau=log.tau + slow)
    found = with_motion_noise(estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False))
    motion = found.motions[0]
    assert (found.fit.sigma > 2.5 * motion.torque_noise).all()
    assert (found.fit.sigma < 1.7 * noise_of(found)).all()
    assert all(r.near for r in remainders(found))
