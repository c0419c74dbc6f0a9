"""The noise below the torque's cutoff is that of what is compared, also where a log is too short to filter."""

import numpy as np
import pytest

from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import Filtering, prepare

SIGMA, RATE, CUTOFF = 0.1, 50.0, 2.0


@pytest.mark.parametrize("seconds", [4.0, 60.0])
def test_noise_is_that_of_the_compared_torque(seconds):
    t = np.arange(0.0, seconds, 1.0 / RATE)
    rng = np.random.default_rng(0)
    tau = SIGMA * rng.normal(size=(len(t), 1))
    log = Log("short", ("a",), t, np.sin(t)[:, None], tau=tau)
    motion = prepare(log, Filtering(4.0, CUTOFF))
    assert (len(motion.decimator.taps) == 1) == (seconds < 10.0)
    left = motion.low_torque.std()
    # its level is told by a few hundred samples, or by as many independent ones as the band leaves
    assert motion.torque_noise[0] == pytest.approx(left, rel=0.25)
