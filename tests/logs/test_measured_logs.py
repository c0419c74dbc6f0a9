"""The measured logs and practice cases, read as they are and through CSV."""

import json

import numpy as np
import pytest
from log_samples import assert_same

from jaxswarm.errors import InputError
from jaxswarm.logs import read_log, summarize, write_log

ARM = tuple(f"joint{k}" for k in range(1, 7))
LOGS = {
    "emps/train.npz": (("slide",), 1000.0, 24841, ("q_ref",)),
    "emps/test.npz": (("slide",), 1000.0, 24841, ("q_ref", "pulse")),
    "kuka_kr300/train.npz": (ARM, 250.0, 2501, ("q_link",)),
    "kuka_kr300/test2.npz": (ARM, 250.0, 2501, ("q_link",)),
    "tx40/train.npz": (ARM, 5000.0, 25000, ()),
    "ur10e/train.npz": (ARM, 93.7, 4736, ("current",)),
    "ur10e/test_ptp.npz": (ARM, 93.7, 3501, ("current",)),
}
GAIN = np.ones(6)


@pytest.mark.parametrize("name", LOGS)
def test_measured_log(data_root, name):
    joints, rate, samples, channels = LOGS[name]
    log = read_log(data_root / "data" / name, joints, GAIN)
    found = summarize(log)
    assert log.q.shape == (samples, len(joints)) and log.tau.shape == log.q.shape
    assert found.sampling.rate == pytest.approx(rate, rel=0.005)
    assert set(log.channels) == set(channels)
    assert found.still_joints == () and found.sampling.gaps == ()
    assert all(joint.wraps == joint.stuck == joint.saturated == 0 for joint in found.joints)
    # The logged velocities of these controllers are derivatives of the positions.
    ratios = [joint.velocity_ratio for joint in found.joints]
    assert all(ratio is None or ratio == pytest.approx(1.0, abs=0.002) for ratio in ratios)


def test_quanta_that_the_sources_state(data_root):
    found = summarize(read_log(data_root / "data/tx40/train.npz", ARM))
    assert 2e-5 < found.joints[0].position_quantum < 5e-5
    found = summarize(read_log(data_root / "data/emps/train.npz", ("slide",)))
    assert found.joints[0].position_quantum == pytest.approx(5e-8, rel=0.01)


def test_irregular_controller_log_is_told(data_root):
    log = read_log(data_root / "data/ur10e/train.npz", ARM, GAIN)
    assert any(note.startswith("Sampling is irregular: 93.92 Hz") for note in log.notes)
    assert any("drive gain" in note for note in log.notes)


def test_currents_need_drive_gains(data_root):
    path = data_root / "data/ur10e/train.npz"
    gain = np.array(
        json.loads((path.parent / "kinematics.json").read_text())["drive_gain_Nm_per_A"]
    )
    log = read_log(path, ARM, gain)
    assert np.allclose(log.tau, log.channels["current"] * gain)
    with pytest.raises(InputError, match="no drive gain for joint1"):
        read_log(path, ARM)


def test_secondary_encoder_is_missing_where_there_is_none(data_root):
    link = read_log(data_root / "data/kuka_kr300/train.npz", ARM).channels["q_link"]
    assert np.isfinite(link[:, :3]).all() and np.isnan(link[:, 3:]).all()


@pytest.mark.parametrize("name", ["kuka_kr300/train.npz", "ur10e/test_ptp.npz"])
def test_measured_log_through_csv(data_root, tmp_path, name):
    log = read_log(data_root / "data" / name, ARM, GAIN)
    write_log(log, tmp_path / "log.csv")
    assert_same(read_log(tmp_path / "log.csv", ARM, GAIN), log)


def test_practice_cases_are_clean(data_root):
    paths = sorted((data_root / "cases").glob("p*/t*.npz"))
    assert paths
    for path in paths:
        log = read_log(path, ARM[:3])
        assert log.q.shape == (5000, 3), path
        assert log.notes == (), path
        assert ("tau_clean" in log.channels) == (path.stem == "test")


def test_wrong_robot_is_refused(data_root):
    with pytest.raises(InputError, match="the log has 6 joints .* the robot has 3"):
        read_log(data_root / "data/tx40/train.npz", ARM[:3])
    with pytest.raises(InputError, match="joints names slide, which the robot does not have"):
        read_log(data_root / "data/emps/train.npz", ("joint1",))
