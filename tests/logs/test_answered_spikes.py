"""A torque of one sample that the motion answers is none of the sensor."""

import numpy as np
import pytest

from jaxswarm.logs.log import Log
from jaxswarm.logs.spikes import bridged

ROW, PERIOD, INERTIA = 700, 0.004, 8.0


def shaken(impulse: float) -> Log:
    """Two joints, the first of which gets a torque of one sample that its speed answers, both noisy.

    ``impulse`` [N m s].
    """
    rng = np.random.default_rng(2)
    t = PERIOD * np.arange(3000)
    q = np.column_stack([0.4 * np.sin(2.0 * t), 0.3 * np.sin(3.0 * t)])
    q[:, 0] += impulse / INERTIA * np.clip(t - t[ROW], 0.0, None) * np.exp(-3.0 * (t - t[ROW]))
    torque = np.column_stack([20.0 * np.cos(2.0 * t), 5.0 * np.sin(3.0 * t)])
    return Log(
        t=t,
        q=np.round(q / 1e-5) * 1e-5,
        tau=torque + 0.2 * rng.normal(size=q.shape),
        joints=("j1", "j2"),
        source="shaken",
    )


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_torque_that_the_motion_answers_stays_on_all_joints(sign):
    log = shaken(sign * 0.8)
    log.tau[ROW] += sign * np.array([200.0, -30.0])
    mended, found = bridged(log)
    assert found == []
    np.testing.assert_array_equal(mended.tau, log.tau)


@pytest.mark.parametrize("impulse", [0.0, -0.8])
def test_one_that_it_does_not_answer_is_a_spike(impulse):
    """Nor is it one that the speed answers in the other direction."""
    log = shaken(impulse)
    log.tau[ROW] += [200.0, -30.0]
    mended, found = bridged(log)
    assert len(found) == 2
    assert np.abs(mended.tau[ROW] - log.tau[ROW] + [200.0, -30.0]).max() < 2.0


def test_a_position_that_fails_in_the_same_sample_answers_nothing():
    log = shaken(0.0)
    log.tau[ROW] += [200.0, -30.0]
    log.q[ROW, 0] += 1.0
    assert len(bridged(log)[1]) == 3
