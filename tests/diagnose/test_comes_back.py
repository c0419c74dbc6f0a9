"""What is left without a law is told to come back with the motion, or not to."""

import numpy as np
import pytest
from planted import BAND, DECLARED, blank, small_arm

from jaxswarm.diagnose.decision.remainder import remainders
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.report.remains import look_at, remaining
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import Noise, synthetic_log
from jaxswarm.logs.motion import prepare

PERIOD = 4.0


def periodic(seconds: float) -> tuple[np.ndarray, ...]:
    """Two joints on a path that is the same again after every period."""
    t = np.arange(0.0, seconds, 1.0 / 125.0)
    base = 2.0 * np.pi / PERIOD
    w, a, p = base * np.array([[1, 2], [3, 1]]), np.array([[0.7, 0.3], [0.2, 0.9]]), [0.3, 1.1]
    phase = t[:, None, None] * w + np.asarray(p)
    waves = np.sin(phase), w * np.cos(phase), -(w**2) * np.sin(phase)
    return t, *((a * wave).sum(axis=1) for wave in waves)


def left(hidden: tuple[Term, ...] = (), lasting: float = 0.0):
    log = synthetic_log(
        small_arm(), (*DECLARED, *hidden), 1, noise=Noise(2e-5, 0.02), moved=periodic(40.0)
    )
    rng, noise = np.random.default_rng(5), np.zeros(len(log.t))
    for k in range(1, len(noise)):  # a first-order process that forgets within a second
        noise[k] = (1.0 - 1.0 / 125.0) * noise[k - 1] + rng.normal() * np.sqrt(2.0 / 125.0)
    log.tau[:, 0] += lasting * noise
    found = estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False)
    return remainders(with_motion_noise(found))[0]


def told(one) -> dict:
    period, alike = one.again
    assert period == pytest.approx(PERIOD, abs=0.02)
    windows = [{"log": log, "start": start, "end": end} for log, start, end in one.windows]
    return {
        "joint": "joint1",
        "depends_on": [],
        "over_noise": one.over_noise,
        "windows": windows,
        "band_hz": one.band,
        "again": {"period_s": period, "correlation": alike},
    }


def test_a_law_of_the_motion_comes_back_with_it():
    worn = Term("position_dependent_friction", 0, values={"sine": 0.5, "cosine": 0.2, "n": 3.0})
    one = left((worn,))
    assert one.again[1] > 0.95 * (1.0 - 1.0 / one.over_noise**2)
    assert " % of which comes back when the motion repeats, after 4 s" in remaining(told(one))
    assert "not one of the motion" not in look_at(told(one))[0]


def test_noise_that_lasts_does_not():
    one = left(lasting=0.3)
    assert one.over_noise > 2.0
    assert abs(one.again[1]) < 0.2
    assert "hardly any of which comes back when the motion repeats" in remaining(told(one))
    assert "not one of the motion" in look_at(told(one))[0]
