"""Joints that turn the other way or from another zero than in the file are told, with what the file has."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jaxswarm.identify.checks import channels
from jaxswarm.identify.checks.check_log import against_robot
from jaxswarm.identify.checks.conventions import CONVENTION, Joint
from jaxswarm.identify.checks.guess import Guess, OtherRobot
from jaxswarm.identify.checks.sound import Tried
from jaxswarm.logs.motion import Filtering
from jaxswarm.logs.segments import prepare_segments

QUARTER = 0.5 * np.pi
OTHER_WAY = (1.0, -1.0, 1.0, -1.0, 1.0, 1.0), (0.0,) * 6, "joint2 = -logged, joint4 = -logged"
OTHER_ZERO = (
    (1.0,) * 6,
    (0.0, -QUARTER, 0.0, QUARTER, 0.0, 0.0),
    "joint2 = logged - 1.571, joint4 = logged + 1.571",
)
BOTH = (
    (1.0, 1.0, -1.0, 1.0, 1.0, 1.0),
    (0.0, 0.0, QUARTER, 0.0, 0.0, 0.0),
    "joint3 = -logged + 1.571",
)


def found(arm, log):
    return against_robot(arm, prepare_segments(log, Filtering(torque_cutoff=5.0))[1])


@pytest.mark.parametrize(("sign", "zero", "told"), [OTHER_WAY, OTHER_ZERO, BOTH])
def test_another_convention_is_told_by_what_the_file_has(arm, log, sign, zero, told):
    other = replace(log, q=np.array(sign) * (log.q - np.array(zero)), tau=np.array(sign) * log.tau)
    (finding,) = found(arm, other)
    assert finding.check == CONVENTION and finding.refused
    assert f"than in the robot's file, where {told}:" in finding.what


def test_the_files_own_convention_is_not(arm, log):
    assert found(arm, log) == []


def test_columns_that_fit_no_convention_are_not_told_as_one(arm, log):
    """Of torques in another order a turned arm leaves a little less, and still nearly all."""
    order = [5, 4, 3, 2, 1, 0]
    told = found(arm, replace(log, q=log.q[:, order], tau=log.tau[:, order]))
    assert CONVENTION not in {finding.check for finding in told}


@pytest.mark.parametrize(("scale_leaves", "told"), [(0.3, CONVENTION), (0.4, None)])
def test_of_a_poor_log_that_is_refused_the_likelier_cause_is_told(
    arm, monkeypatch, scale_leaves, told
):
    """Nothing more is refused: a convention that leaves as much alone is not believed."""
    braking = np.ones(6)
    logged, other, scale = (Tried(np.full(6, x), braking) for x in (0.42, 0.18, scale_leaves))
    tried = [
        (Guess("encoder_scale", "the position of joint4 is half", (3,)), scale),
        (OtherRobot(CONVENTION, "joints have other signs", (3,)), other),
    ]
    monkeypatch.setattr(channels, "every_guess", lambda *_: tried)
    known = SimpleNamespace(as_logged=lambda: (logged, np.ones(6)), strictness=1.0)
    finding = channels.wrong_channels(arm, known, lambda: known)
    assert (finding and finding.check) == told


def test_changes_of_a_joint_follow_each_other():
    """x -> -x + a, then -> -x + b: x -> x - a + b."""
    once = Joint(-1.0, 1)
    assert once.then(Joint(-1.0, 2)) == Joint(1.0, 1)
    assert once.then(once) == Joint()
