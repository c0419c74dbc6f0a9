"""Velocities and accelerations that contradict the position, and torques that measure nothing."""

from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.logs import Log
from jaxswarm.logs.consistency import refuse_dead_torque
from jaxswarm.logs.segments import prepare_segments

JOINTS = ("joint1", "joint2")


def made(seed=0, length=3000, rate=200.0):
    rng = np.random.default_rng(seed)
    t = np.arange(length) / rate
    phase = np.array([0.0, 1.0])
    w = 2 * np.pi * np.array([0.5, 0.7])
    q = np.sin(np.outer(t, w) + phase)
    dq = w * np.cos(np.outer(t, w) + phase)
    ddq = -(w**2) * q
    tau = 3 * ddq + 2 * dq + 0.1 * rng.normal(size=q.shape)
    noisy = q + 1e-5 * rng.normal(size=q.shape)
    return Log("made", JOINTS, t, noisy, dq + 0.02 * rng.normal(size=q.shape), ddq, tau)


def prepared(**changes):
    """The log of which motions are made, and with which it is fitted."""
    log = replace(made(), **changes)
    refuse_dead_torque(log)
    return prepare_segments(log)[0]


def test_channels_that_belong_together_stay():
    log = made()
    found = prepared()
    assert found.dq is not None and found.ddq is not None
    assert not any("contradicts" in note for note in found.notes)
    # A bias of the sensor is taken off and no contradiction; neither is coarse noise.
    assert prepared(dq=log.dq + [0.3, 0.0]).dq is not None
    rough = np.random.default_rng(1).normal(size=log.dq.shape)
    assert prepared(dq=log.dq + 0.5 * rough).dq is not None


@pytest.mark.parametrize(
    "spoil",
    [
        lambda dq: 0.0 * dq,
        lambda dq: 0.0 * dq + 0.7,
        lambda dq: -dq,
        lambda dq: 1.3 * dq,
        lambda dq: dq[:, ::-1].copy(),
        lambda dq: dq * [1.0, 180.0 / np.pi],
    ],
    ids=["zero", "constant", "negated", "scaled", "swapped", "degrees"],
)
def test_a_velocity_that_contradicts_is_left_out(spoil):
    found = prepared(dq=spoil(made().dq))
    assert found.dq is None
    assert any("velocity contradicts the position on" in note for note in found.notes)
    assert found.ddq is not None


@pytest.mark.parametrize("factor", [0.0, -1.0, 1.5])
def test_an_acceleration_that_contradicts_is_left_out(factor):
    found = prepared(ddq=factor * made().ddq)
    assert found.ddq is None and found.dq is not None
    assert any("acceleration contradicts the velocity" in note for note in found.notes)
    found = prepared(ddq=factor * made().ddq, dq=None)
    assert found.ddq is None


def test_a_joint_that_only_trembles_decides_nothing():
    log = made()
    q, dq = log.q.copy(), log.dq.copy()
    q[:, 1] = 1e-3 * np.random.default_rng(2).normal(size=len(q))
    dq[:, 1] = 0.0
    assert prepared(q=q, dq=dq, ddq=None).dq is not None


@pytest.mark.parametrize("value", [0.0, 2.5])
def test_a_dead_torque_is_refused_with_its_joint(value):
    tau = made().tau.copy()
    tau[:, 1] = value
    with pytest.raises(InputError, match=r"torque of joint2 is .* dead"):
        prepared(tau=tau)


def test_a_dead_torque_of_a_joint_at_rest_is_refused_too():
    log = made()
    q, tau = log.q.copy(), log.tau.copy()
    q[:, 1], tau[:, 1] = 0.3, 0.0
    with pytest.raises(InputError, match="torque of joint2 is 0 in every sample"):
        prepared(q=q, tau=tau, dq=None, ddq=None)


@pytest.mark.parametrize("bias", [0.05, -0.02])
def test_a_constant_error_of_a_velocity_is_taken_off_and_told(bias):
    log = made()
    noise = 0.02 * np.random.default_rng(4).normal(size=log.dq.shape)
    clean = prepared(dq=log.dq + noise)
    wrong = prepared(dq=log.dq + noise + [bias, 0.0])
    (note,) = set(wrong.notes) - set(clean.notes)
    assert f"velocity of {JOINTS[0]} is" in note
    assert float(note.split(" is ")[1].split()[0]) == pytest.approx(bias, abs=2e-3)
    assert not any("velocity" in text for text in clean.notes)
    np.testing.assert_allclose(wrong.dq, clean.dq, atol=2e-3)


def test_all_dead_torques_are_held_still_by_one_option():
    """A gripper publishes zeros for its fingers: the remedy is the option that leaves them out."""
    log = made()
    with pytest.raises(InputError, match="--lock joint1,joint2$"):
        refuse_dead_torque(replace(log, tau=0.0 * log.tau))
    with pytest.raises(InputError, match="--lock joint2$"):
        refuse_dead_torque(replace(log, tau=log.tau * [1.0, 0.0]))
    still = np.column_stack([log.q[:, 0], np.full(len(log.t), 0.02)])
    with pytest.raises(InputError, match="--lock joint2=0.02$"):
        refuse_dead_torque(replace(log, q=still, tau=log.tau * [1.0, 0.0]))
