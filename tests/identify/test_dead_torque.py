"""Channels that hold noise in the place of a torque or a position are named before anything is fitted."""

import json
from dataclasses import replace

import numpy as np
import pytest
from slide import run

from benchmarks.trust.arms import clean_arm
from jaxswarm.errors import InputError
from jaxswarm.identify.checks.check_log import checked
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.samples import samples_of
from jaxswarm.logs import Log, read_log
from jaxswarm.logs.motion import Filtering, prepare
from jaxswarm.robot.load import load_robot


@pytest.fixture(scope="module")
def arm():
    return load_robot("rx60")


@pytest.fixture(scope="module")
def clean(data_root, arm):
    return read_log(data_root / "cases" / "p01" / "train.npz", arm.joints)


def with_noise(log: Log, joint: int, size: float) -> Log:
    tau = log.tau.copy()
    tau[:, joint] = size * np.random.default_rng(joint).normal(size=len(log.t))
    return replace(log, tau=tau)


@pytest.mark.parametrize("size", [1e-9, 0.05, 5.0])
@pytest.mark.parametrize("joint", [0, 1, 2])
def test_a_torque_of_noise_is_named_where_the_others_contradict_it(clean, arm, joint, size):
    log = with_noise(clean, joint, size)
    words = (
        f"no_relation: the torque of joint{joint + 1} has nothing to do .*--lock joint{joint + 1}"
    )
    with pytest.raises(InputError, match=words):
        checked(log, arm, Filtering())
    told, motions = checked(log, arm, Filtering(), accept=["no_relation"])
    assert motions and any(note.startswith("no_relation: ") for note in told.notes)


def test_a_torque_of_noise_that_nobody_contradicts_is_told():
    arm = clean_arm(0)
    last = arm.robot.num_joints - 1
    told, _ = checked(with_noise(arm.log, last, 1e-3), arm.robot, Filtering())
    (note,) = [note for note in told.notes if note.startswith("no_relation: ")]
    assert arm.robot.joints[last] in note
    clean, _ = checked(arm.log, arm.robot, Filtering())
    assert not any(note.startswith("no_relation: ") for note in clean.notes)


def test_positions_of_noise_leave_few_rows_and_are_not_judged(clean, tmp_path):
    rng = np.random.default_rng(1)
    noise = rng.normal(size=clean.q.shape)
    np.savez(tmp_path / "log.npz", t=clean.t, q=noise, tau=rng.normal(size=clean.q.shape))
    out = tmp_path / "out"
    code, _, err = run("diagnose", tmp_path / "log.npz", "--robot", "rx60", "--out", out)
    assert code == 0, err
    result = json.loads((out / "diagnosis.json").read_text())
    assert result["verdict"] == "cannot be judged" and "no_relation" in err


def test_a_torque_that_follows_its_own_motion_is_no_noise():
    """Noise is left whole by its joint's own columns, a law that nobody knows is not."""
    arm = clean_arm(0)
    last = arm.robot.num_joints - 1
    shown = [arm.log, with_noise(arm.log, last, 1.0)]
    tau = arm.log.tau.copy()
    tau[:, last] = np.sin(3.0 * arm.log.q[:, last]) + 0.5 * np.sin(arm.log.q).sum(axis=1)
    shown.append(replace(arm.log, tau=tau))
    clean, noise, law = (Rough(arm.robot, samples_of([prepare(log)])).alone(last) for log in shown)
    assert clean < 0.2 and law < 0.7 and 0.75 < noise < 1.1
