"""Over which band torques are compared: where the motion of every joint that moves is known."""

import numpy as np
import pytest
from scipy import signal

from jaxswarm.logs.bands import TORQUE_BAND, find_band
from jaxswarm.logs.log import Log
from jaxswarm.logs.segments import prepare_segments

RATE = 250.0
JOINTS = ("shoulder", "elbow", "wrist")


def positions(coarse: float, swing: float = 0.5) -> np.ndarray:
    """Three joints that move up to some 30 Hz, the first with an encoder of its own noise."""
    rng, t = np.random.default_rng(0), np.arange(6000) / RATE
    hertz = np.geomspace(0.2, 30.0, 25)
    q = np.stack(
        [
            (np.sin(2 * np.pi * hertz * t[:, None] + rng.uniform(0, 6, 25)) / hertz**2)
            @ np.ones(25)
            for _ in JOINTS
        ],
        axis=1,
    )
    q *= np.array([swing, 0.5, 0.5]) / np.ptp(q, axis=0)
    return q + rng.normal(size=q.shape) * np.array([coarse, 1e-6, 1e-6])


def test_torques_are_compared_no_further_than_the_motion_of_any_joint_is_known():
    found = find_band(positions(2e-4), RATE, JOINTS)
    assert found.motion[0] < 0.5 * found.motion[1:].min()
    assert found.torque == pytest.approx(found.motion[0])


def test_where_all_are_known_alike_the_median_decides():
    found = find_band(positions(1e-6), RATE, JOINTS)
    assert found.torque == pytest.approx(TORQUE_BAND / 1.4 * np.median(found.motion))
    assert found.torque < found.motion.min()


def test_a_joint_that_hardly_moves_hides_no_torque_of_the_others():
    found = find_band(positions(2e-4, swing=4e-3), RATE, JOINTS)
    assert found.motion[0] < 0.3 * found.torque


@pytest.mark.parametrize("rate", [1000.0, 4000.0])
def test_a_slow_motion_sampled_often_keeps_its_velocity(rate):
    """The smoothing lost its digits: dq was told not to be the derivative of q, or the system not solved."""
    t, rng = np.arange(0, 20, 1 / rate), np.random.default_rng(0)
    q = np.sin(0.2 * np.pi * t) + 0.3 * np.sin(0.54 * np.pi * t + 0.4)
    dq = 0.2 * np.pi * (np.cos(0.2 * np.pi * t) + 0.81 * np.cos(0.54 * np.pi * t + 0.4))
    q, dq = q + 1e-4 * rng.normal(size=len(t)), dq + 1e-3 * rng.normal(size=len(t))
    found = find_band(q[:, None], rate, ("shoulder",), dq[:, None])
    assert not found.notes
    assert found.ratio == pytest.approx(0.01, rel=0.2)


@pytest.mark.parametrize(
    ("late", "used"), [(0.0, True), (1e-3, True), (4e-3, False), (-4e-3, False)]
)
def test_a_late_velocity_is_not_used(late, used):
    """One that a filter made 7.3 ms late moved a whole torque by 1 ms: told as a delay of the torque."""
    t, rng = np.arange(0, 16, 1 / 500.0), np.random.default_rng(0)
    q = np.sin(0.8 * np.pi * t) + 0.3 * np.sin(1.3 * np.pi * t + 0.4)
    dq = np.gradient(np.interp(t - late, t, q), t)
    q, dq = q + 1e-4 * rng.normal(size=len(t)), dq + 1e-3 * rng.normal(size=len(t))
    found = find_band(q[:, None], 500.0, ("shoulder",), dq[:, None])
    assert (found.ratio is not None) == used
    log = Log("late.csv", ("shoulder",), t, q[:, None], dq[:, None])
    told = prepare_segments(log)[0].notes
    how = "late" if late > 0.0 else "early"
    assert any(f"dq of shoulder is 4 ms {how}" in note for note in told) != used


@pytest.mark.parametrize("driven", [True, False], ids=["driven", "noise"])
def test_what_the_torque_goes_with_beyond_a_valley_is_motion(driven):
    """What impacts leave of a motion lies beyond a dip of its spectrum, as noise that was filtered does."""
    rate, rng = 250.0, np.random.default_rng(7)
    t = np.arange(5000) / rate
    slow = sum(0.1 * np.sin(2 * np.pi * f * t + f) / f for f in (0.3, 0.8, 1.3))
    band = signal.butter(5, (14.0, 25.0), btype="bandpass", fs=rate, output="sos")
    fast = 4e-4 * signal.sosfiltfilt(band, rng.normal(size=len(t)))
    q = slow + fast + 2e-5 * rng.normal(size=len(t))
    moved = slow + fast if driven else slow
    torque = 3.0 * np.gradient(np.gradient(moved, t), t) + 0.3 * rng.normal(size=len(t))
    found = find_band(q[:, None], rate, ("j",), torque=torque[:, None])
    if driven:
        assert found.motion[0] > 25.0
    else:
        assert found.motion[0] < 15.0
    # Torques are compared below the dip in either case.
    assert found.torque < 15.0
