"""A log spoiled in one way is found to be so before anything is fitted, and clean logs are not doubted."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from slide import run

from jaxswarm import tasks
from jaxswarm.effects.friction import USUAL_FRICTION
from jaxswarm.errors import InputError
from jaxswarm.identify.checks.check_log import CHECKS, checked
from jaxswarm.logs import Log, read_log
from jaxswarm.logs.motion import Filtering
from jaxswarm.logs.pace import slow_clock
from jaxswarm.robot.load import load_robot

RNG = np.random.default_rng(7)


def column(values: np.ndarray, joint: int, change) -> np.ndarray:
    changed = values.copy()
    changed[:, joint] = change(values[:, joint])
    return changed


def late(t: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.interp(t - 0.02, t, values)


def with_spikes(log: Log, quantity: str, count: int) -> Log:
    values = getattr(log, quantity).copy()
    rows = RNG.choice(np.arange(5, len(values) - 5), count, replace=False)
    values[rows, 1] += np.ptp(values[:, 1]) * RNG.choice([-1.0, 1.0], count)
    return replace(log, **{quantity: values})


def with_loss(log: Log) -> Log:
    """A fifth of the samples lost, the time stamps closed up."""
    kept = np.sort(RNG.choice(len(log.t), int(0.8 * len(log.t)), replace=False))
    return Log(log.source, log.joints, log.t[: len(kept)], log.q[kept], tau=log.tau[kept])


def with_stop(log: Log) -> Log:
    q = log.q.copy()
    q[1500:2250, 1] = q[1500, 1]
    return replace(log, q=q, dq=None)


def clipped(log: Log, share: float) -> Log:
    limit = share * np.abs(log.tau).max(axis=0)
    return replace(log, tau=np.clip(log.tau, -limit, limit))


REFUSED = {
    "torque of joint 2 negated": (
        "torque_sign", lambda log: replace(log, tau=column(log.tau, 1, np.negative))),
    "all torques negated": ("torque_sign", lambda log: replace(log, tau=-log.tau)),
    "position of joint 3 negated": (
        "position_sign", lambda log: replace(log, q=column(log.q, 2, np.negative), dq=None)),
    "torques of joints 2 and 3 swapped": (
        "swapped_channels", lambda log: replace(log, tau=log.tau[:, [0, 2, 1]])),
    "torques in a circle": (
        "swapped_channels", lambda log: replace(log, tau=log.tau[:, [1, 2, 0]])),
    "positions of joints 1 and 2 swapped": (
        "swapped_channels", lambda log: replace(log, q=log.q[:, [1, 0, 2]], dq=None)),
    "degrees": ("encoder_scale", lambda log: replace(log, q=np.degrees(log.q), dq=None)),
    "positions of joint 2 twice as large": (
        "encoder_scale", lambda log: replace(log, q=column(log.q, 1, lambda x: 2 * x), dq=None)),
    "torque of joint 2 halved": (
        "torque_scale", lambda log: replace(log, tau=column(log.tau, 1, lambda x: 0.5 * x))),
    "torque of joint 3 in mN m": (
        "torque_scale", lambda log: replace(log, tau=column(log.tau, 2, lambda x: 1e3 * x))),
    "time twice as slow": ("time_scale", lambda log: replace(log, t=2 * log.t, dq=None)),
    "time twice as fast": ("time_scale", lambda log: replace(log, t=0.5 * log.t, dq=None)),
    "torque of joint 1 late by 20 ms": (
        "late_torque", lambda log: replace(log, tau=column(log.tau, 0, lambda x: late(log.t, x)))),
    "kN m": ("torque_unit", lambda log: replace(log, tau=1e-3 * log.tau)),
    "mN m": ("torque_unit", lambda log: replace(log, tau=1e3 * log.tau)),
    "three percent of spikes": ("spikes", lambda log: with_spikes(log, "tau", 150)),
    "lost samples": ("lost_samples", with_loss),
    "torques clipped at 0.7": ("saturation", lambda log: clipped(log, 0.7)),
}  # fmt: skip
TOLD = {
    "torque spikes": ("spikes", lambda log: with_spikes(log, "tau", 5)),
    "position spikes": ("spikes", lambda log: with_spikes(log, "q", 5)),
    "stuck encoder": ("stuck", with_stop),
    "torques clipped at 0.95": ("saturation", lambda log: clipped(log, 0.95)),
    "noise": ("no_relation", lambda log: replace(log, tau=RNG.normal(size=log.tau.shape))),
    "torque in another order of time": (
        "no_relation", lambda log: replace(log, tau=log.tau[RNG.permutation(len(log.t))])),
}  # fmt: skip


# What leaving time out makes of a log.
GAPS = "Split at ", "Left out, too short", "8 gaps of up to "


@pytest.fixture(scope="module")
def arm():
    return load_robot("rx60")


@pytest.fixture(scope="module")
def clean(data_root, arm):
    return read_log(data_root / "cases" / "p01" / "train.npz", arm.joints)


def new_notes(log: Log, after: Log) -> list[str]:
    return [note for note in after.notes if note not in log.notes]


@pytest.mark.parametrize("spoiling", REFUSED)
def test_what_cannot_be_right_is_refused_by_name_unless_accepted(clean, arm, spoiling):
    check, spoil = REFUSED[spoiling]
    log = spoil(clean)
    with pytest.raises(InputError, match=f"{check}: .*--accept {check}"):
        checked(log, arm, Filtering())
    told, motions = checked(log, arm, Filtering(), accept=[check])
    assert motions and any(note.startswith(f"{check}: ") for note in new_notes(log, told))


@pytest.mark.parametrize("spoiling", TOLD)
def test_what_can_be_mended_or_judged_is_told(clean, arm, spoiling):
    check, spoil = TOLD[spoiling]
    log = spoil(clean)
    told, _ = checked(log, arm, Filtering())
    names = {note.split(":")[0] for note in new_notes(log, told)}
    assert {name for name in names if not name.startswith(GAPS)} == {check}


def test_a_refusal_tells_what_was_found_before_too(clean, arm):
    """An encoder that stood may be why time seems to run at another pace."""
    log = with_stop(clean)
    log = replace(log, tau=column(log.tau, 2, np.negative))
    with pytest.raises(InputError, match="torque_sign: .*Besides, stuck: the position of joint2"):
        checked(log, arm, Filtering())


def test_a_table_converted_to_degrees_has_slides_that_travel_meters(data_root):
    robot = load_robot(data_root / "cases" / "q03" / "robot.urdf")
    log = read_log(data_root / "cases" / "q03" / "train.npz", robot.joints)
    with pytest.raises(InputError, match=f"encoder_scale: .*{robot.joints[3]} are in degrees"):
        checked(replace(log, q=np.degrees(log.q), dq=None), robot, Filtering())


def test_milliseconds_of_a_fast_log_are_told(data_root):
    """Of five kilohertz they seem to be five samples a second."""
    robot = load_robot("tx40")
    log = read_log(data_root / "data" / "tx40" / "train.npz", robot.joints)
    with pytest.raises(InputError, match="time_scale: .*--columns t:ms"):
        checked(replace(log, t=1e3 * log.t, dq=None), robot, Filtering())


def test_a_joint_that_creeps_is_not_taken_for_one_in_milliseconds():
    """A degree a second, to and fro, as of a test of friction."""
    t = np.arange(0.0, 400.0, 0.1)
    way = np.deg2rad(20.0) * np.abs((t / 20.0) % 2.0 - 1.0)
    assert slow_clock(Log("creeping", ("joint1",), t, way[:, None])) == []


def test_torques_light_for_an_arm_of_unknown_masses_are_told(clean, arm):
    bare = arm.replace(parameters=np.zeros((3, 10)))
    told, _ = checked(replace(clean, tau=1e-3 * clean.tau), bare, Filtering())
    assert any("--columns tau:kNm" in note for note in told.notes)


def test_bridged_spikes_leave_the_log_as_it_was(clean, arm):
    log, motions = checked(with_spikes(clean, "tau", 5), arm, Filtering())
    noise = np.std(np.diff(clean.tau[:, 1], 3)) / np.sqrt(20.0)
    assert np.abs(log.tau - clean.tau).max() < 6.0 * noise


def test_samples_at_a_limit_cost_little_when_they_are_left_out(clean, arm, data_root):
    """A joint at its limit in a tenth of the samples: as good on other motion, ten times worse as it is."""
    other = read_log(data_root / "cases" / "p01" / "test.npz", arm.joints)
    limit = np.quantile(np.abs(clean.tau[:, 1]), 0.9)
    log = replace(clean, tau=column(clean.tau, 1, lambda x: np.clip(x, -limit, limit)))
    as_it_was, left_out = (
        tasks.identify(one, arm, USUAL_FRICTION, validation=other)["error"]["validation"]["rms"]
        for one in (clean, log)
    )
    assert left_out[1] < 1.2 * as_it_was[1]


def test_the_time_of_a_stuck_encoder_is_left_out(clean, arm):
    log, motions = checked(with_stop(clean), arm, Filtering())
    assert len(motions) == 2
    start, end = clean.t[1500], clean.t[2249]
    assert not ((log.t > start) & (log.t < end)).any()


@pytest.mark.parametrize(
    ("name", "robot"),
    [
        ("cases/p01/train.npz", "rx60"),
        ("cases/q03/train.npz", "cases/q03/robot.urdf"),
        # Laws that a wrong scale or a late torque could be taken for.
        ("cases/p06/train.npz", "rx60"),
        ("cases/p10/train.npz", "rx60"),
        ("cases/p13/train.npz", "rx60"),
        ("cases/p14/train.npz", "rx60"),
        ("data/emps/train.npz", "emps"),
        ("data/ur10e/train.npz", "ur10e"),
        # Bristles of its harmonic drives look 30 ms late.
        ("data/ur10e/train2.npz", "ur10e"),
    ],
)
def test_logs_that_are_right_are_not_doubted(data_root, name, robot):
    found = load_robot(robot if "/" not in robot else data_root / robot)
    log = read_log(data_root / name, found.joints, np.asarray(found.drive_gain))
    after, _ = checked(log, found, Filtering())
    assert not [n for n in new_notes(log, after) if n.split(":")[0] in CHECKS]


COMMANDS = {
    "identify": ("--effects", "identification.json"),
    "diagnose": ("--declare", "diagnosis.json"),
}


def written(clean: Log, path: Path, tau: np.ndarray) -> Path:
    np.savez(path, t=clean.t, q=clean.q, tau=tau, joints=np.array(clean.joints))
    return path


@pytest.mark.parametrize("command", COMMANDS)
def test_a_refused_log_leaves_nothing_behind(clean, tmp_path, command):
    flipped = clean.tau * [1.0, -1.0, 1.0]
    log, out = written(clean, tmp_path / "log.npz", flipped), tmp_path / "out"
    option = COMMANDS[command][0]
    code, _, err = run(command, log, "--robot", "rx60", option, USUAL_FRICTION, "--out", out)
    assert code == 2 and "--accept torque_sign" in err.replace("\n", " ")
    assert not out.exists()


def test_an_accepted_finding_stays_in_the_result(clean, tmp_path):
    flipped = clean.tau * [1.0, -1.0, 1.0]
    log, out = written(clean, tmp_path / "log.npz", flipped), tmp_path / "out"
    given = "--robot", "rx60", "--effects", USUAL_FRICTION, "--out", out
    code, _, err = run("identify", log, *given, "--accept", "torque_sign")
    assert code == 0 and "note: " in err and "torque_sign" in err
    (finding,) = json.loads((out / "identification.json").read_text())["findings"]
    assert finding["log"] == "log.npz" and finding["what"].startswith("torque_sign: ")


def test_torques_of_another_motion_are_not_diagnosed(clean, tmp_path):
    mixed = clean.tau[RNG.permutation(len(clean.t))]
    log, out = written(clean, tmp_path / "log.npz", mixed), tmp_path / "out"
    code, _, err = run("diagnose", log, "--robot", "rx60", "--out", out)
    assert code == 0, err
    result = json.loads((out / "diagnosis.json").read_text())
    assert result["verdict"] == "cannot be judged" and result["effects"] == []
    assert result["findings"][0]["what"].startswith("no_relation: ")


def test_an_unknown_check_cannot_be_accepted(clean, arm):
    with pytest.raises(InputError, match="unknown check 'torque_sgn'.*torque_sign"):
        checked(clean, arm, Filtering(), accept=["torque_sgn"])


@pytest.mark.parametrize("seconds", [-0.02, 0.02])
def test_the_delay_of_a_torque_is_measured(clean, arm, seconds):
    tau = column(clean.tau, 0, lambda x: np.interp(clean.t - seconds, clean.t, x))
    side = "late" if seconds > 0 else "early"
    with pytest.raises(InputError, match=rf"joint1 is (19|20|21|22|23|24) ms {side}"):
        checked(replace(clean, tau=tau), arm, Filtering())


def test_a_delay_of_all_torques_is_no_joint_s_own(clean, arm):
    tau = np.stack([np.interp(clean.t - 0.015, clean.t, x) for x in clean.tau.T], axis=1)
    log, _ = checked(replace(clean, tau=tau), arm, Filtering())
    assert not any(note.startswith("late_torque") for note in log.notes)


def test_what_no_coupling_tells_is_not_guessed(data_root):
    slide = load_robot("emps")
    log = read_log(
        data_root / "data" / "emps" / "train.npz", slide.joints, np.asarray(slide.drive_gain)
    )
    for changed in (replace(log, tau=2 * log.tau), replace(log, t=2 * log.t, dq=None)):
        after, _ = checked(changed, slide, Filtering())
        assert not [n for n in after.notes if n.split(":")[0] in CHECKS]
