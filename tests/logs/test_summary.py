"""The summary of logs made to have a defect, and the sentence that tells it."""

import json
from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.logs import Log, describe, summarize

TIME = np.arange(4000) * 0.004
PHASE = np.array([0.0, 1.0, 2.0])


def clean() -> Log:
    rng = np.random.default_rng(0)
    angle = 2 * np.pi * np.array([0.4, 0.5, 0.7]) * TIME[:, None] + PHASE
    q = np.sin(angle)
    dq = 2 * np.pi * np.array([0.4, 0.5, 0.7]) * np.cos(angle)
    tau = 20.0 * q + rng.normal(size=q.shape)
    return Log("made", ("joint1", "joint2", "joint3"), TIME, q, dq=dq, tau=tau)


def change(log: Log, name: str, joint: int, values) -> Log:
    array = getattr(log, name).copy()
    array[:, joint] = values
    return replace(log, **{name: array})


def told(log: Log) -> str:
    return "\n".join(describe(summarize(log)))


def test_clean_log_has_nothing_to_tell():
    assert describe(summarize(clean())) == ()


def test_numbers_of_a_clean_log():
    found = summarize(clean())
    first = found.joints[0]
    assert found.samples == 4000 and found.duration == pytest.approx(15.996)
    assert first.position_max == pytest.approx(1.0, abs=1e-3) and first.moves
    assert first.speed_max == pytest.approx(0.8 * np.pi, rel=1e-3)
    # cos(0.8 pi t) changes its sign at (k + 1/2) / 0.8 s: 13 times in 16 s.
    assert first.reversals == 13
    assert first.velocity_ratio == pytest.approx(1.0, abs=1e-3)
    assert first.moving_share > 0.97 and found.moving_share == 1.0
    assert (first.saturated, first.stuck, first.wraps, found.held_share) == (0, 0, 0, 0.0)
    assert first.torque_min < -19.0 and first.torque_max > 19.0


def test_summary_is_plain_numbers():
    found = summarize(clean()).to_dict()
    assert json.loads(json.dumps(found)) == json.loads(json.dumps(found, default=None))
    assert found["joints"][2]["name"] == "joint3"
    without = summarize(replace(clean(), tau=None, dq=None)).to_dict()
    assert without["joints"][0]["torque_max"] is None
    assert without["joints"][0]["velocity_ratio"] is None


@pytest.mark.parametrize("noise", [0.0, 2e-5])
def test_joint_that_never_moves(noise):
    hold = 0.3 + noise * np.random.default_rng(1).normal(size=4000)
    log = change(replace(clean(), dq=None), "q", 1, hold)
    found = summarize(log)
    assert found.still_joints == ("joint2",)
    assert (found.joints[1].reversals, found.joints[1].moving_share) == (0, 0.0)
    assert "joint2 never moves" in told(log)


def test_joint_that_trembles_between_two_counts():
    hold = 0.3 + 0.002 * np.random.default_rng(1).integers(0, 2, size=4000)
    assert summarize(change(replace(clean(), dq=None), "q", 1, hold)).still_joints == ("joint2",)


def test_joint_that_never_reverses():
    log = change(replace(clean(), dq=None), "q", 0, 0.2 * TIME)
    assert "joint1 never reverses" in told(log)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_saturation(sign):
    log = clean()
    log = change(log, "tau", 2, sign * np.clip(sign * log.tau[:, 2], -np.inf, 15.0))
    count = int(np.sum(sign * log.tau[:, 2] == 15.0))
    assert summarize(log).joints[2].saturated == count > 500
    assert "The torque of joint3 sits at its limit" in told(log) and f"{count} samples" in told(log)


def test_stuck_torque():
    log = clean()
    torque = log.tau[:, 0].copy()
    torque[1000:1050] = torque[1000]
    log = change(log, "tau", 0, torque)
    assert summarize(log).joints[0].stuck == 50
    assert "The torque of joint1 keeps one value for 50 samples" in told(log)


def test_samples_held_by_a_slow_source():
    log = clean()
    source = np.arange(4000) // 4 * 4
    log = replace(log, q=log.q[source], dq=log.dq[source], tau=log.tau[source])
    assert summarize(log).held_share == pytest.approx(0.75, abs=0.01)
    assert "75 % of the samples repeat the one before" in told(log)


def test_standstill():
    log = clean()
    rest = np.minimum(np.arange(4000), 1000)
    log = replace(log, q=log.q[rest], dq=None)
    assert summarize(log).moving_share == pytest.approx(0.25, abs=0.01)
    assert "stands still in 75 %" in told(log)


def test_coarse_torque():
    log = clean()
    log = change(log, "tau", 0, np.round(log.tau[:, 0] / 2.5) * 2.5)
    assert summarize(log).joints[0].torque_quantum == pytest.approx(2.5)
    assert "The torque of joint1 is quantized in steps of 2.5" in told(log)


def test_coarse_position():
    log = replace(clean(), dq=None)
    log = change(log, "q", 1, np.round(log.q[:, 1] / 0.05) * 0.05)
    assert summarize(log).joints[1].position_quantum == pytest.approx(0.05)
    assert "The position of joint2 is quantized in steps of 0.05" in told(log)


def test_degrees():
    log = clean()
    log = replace(log, q=np.degrees(log.q))
    assert "joint1 reaches 57.3: positions must be in rad or m" in told(log)
    assert "0.0175 times the derivative of its position (q in degrees?)" in told(log)


@pytest.mark.parametrize(
    ("factor", "hint"),
    [(180 / np.pi, "57.3 times the derivative of its position (degrees?)"), (-1.0, "(sign?)")],
)
def test_velocity_that_is_not_the_derivative(factor, hint):
    log = clean()
    log = change(log, "dq", 1, factor * log.dq[:, 1])
    assert hint in told(log) and "velocity of joint2" in told(log)
    assert "velocity of joint1" not in told(log)


def test_wrapped_angle():
    log = replace(clean(), dq=None)
    angle = (1.5 * TIME + np.pi) % (2 * np.pi) - np.pi
    log = change(log, "q", 0, angle)
    assert summarize(log).joints[0].wraps == int(np.sum(np.abs(np.diff(angle)) > 6.0)) > 0
    assert "joint1 steps by a full turn" in told(log)


def test_clock_sentences():
    log = clean()
    jitter = log.t + 0.001 * np.random.default_rng(2).random(4000)
    assert "Sampling is irregular: 250 Hz on the mean" in told(replace(log, t=jitter))
    jumped = log.t + 3.0 * (np.arange(4000) > 99)
    assert "The clock jumps 1 time while the motion goes on: 3 s after t = 0.396 s" in told(
        replace(log, t=jumped, dq=None)
    )
    keep = np.abs(np.arange(4000) - 500) > 100
    lost = Log("made", log.joints, log.t[keep], log.q[keep], tau=log.tau[keep])
    assert "1 gap in time: 0.808 s after t = 1.596 s" in told(lost)
    assert "12.5 Hz is slow" in told(replace(log, t=20 * log.t, dq=log.dq / 20))


def test_shortest_log_is_summarized():
    log = Log(
        "made", ("slide",), np.array([0.0, 0.1]), np.array([[0.0], [1.0]]), tau=np.ones((2, 1))
    )
    found = summarize(log)
    assert found.samples == 2 and found.sampling.rate == pytest.approx(10.0)
    assert isinstance(describe(found), tuple)
