"""A push that hides how torque and motion belong together; what looks late but leaves far too much."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from slide import run

from jaxswarm.effects.friction import USUAL_FRICTION
from jaxswarm.identify.checks import late
from jaxswarm.identify.checks.check_log import checked
from jaxswarm.logs import read_log
from jaxswarm.logs.motion import Filtering
from jaxswarm.robot.load import load_robot

FIRST, LAST = 8.0, 9.6


@pytest.fixture(scope="module")
def arm():
    return load_robot("rx60")


@pytest.fixture(scope="module")
def clean(data_root, arm):
    return read_log(data_root / "cases" / "p01" / "train.npz", arm.joints)


@pytest.fixture(scope="module")
def pushed(clean):
    inside = (clean.t > FIRST) & (clean.t < LAST)
    push = 6.0 * clean.tau.std(axis=0) * inside[:, None]
    return replace(clean, tau=clean.tau + push, source="pushed")


def test_a_hard_push_does_not_make_motion_and_torque_strangers(pushed, arm):
    told, _ = checked(pushed, arm, Filtering())
    (finding,) = [f for f in told.findings if f.check == "no_relation"]
    first, last = (
        float(x) for x in finding.what.split(" without ")[1].split(" s:")[0].split(" to ")
    )
    assert first < FIRST + 0.3 and LAST - 0.3 < last and last - first < 5.0
    assert not any(f.check == "torque_unit" for f in told.findings)


def test_it_is_diagnosed_as_a_push(pushed, tmp_path):
    log, out = tmp_path / "pushed.npz", tmp_path / "out"
    np.savez(log, t=pushed.t, q=pushed.q, tau=pushed.tau, joints=np.array(pushed.joints))
    given = "--robot", "rx60", "--declare", USUAL_FRICTION, "--out", out
    code, _, err = run("diagnose", log, *given)
    assert code == 0, err
    result = json.loads((out / "diagnosis.json").read_text())
    (effect,) = result["effects"]
    assert effect["effect"] == "contact"
    assert effect["parameters"]["start"]["value"] == pytest.approx(FIRST, abs=0.05)


@pytest.mark.parametrize(
    ("leaves", "refused"), [(0.05, True), (0.16, True), (0.2, False), (0.3, False)]
)
def test_a_delay_that_leaves_much_is_told_but_forbids_nothing(monkeypatch, arm, leaves, refused):
    """As of an imbalance at the tip: two thirds of the squared error of a joint looked early."""
    told = late._Told(
        clear=np.array([False, True, False]),
        apart=np.array([0.0, -0.02, 0.0]),
        gain=np.array([0.0, -0.55, 0.0]),
        leaves=np.array([0.01, leaves, 0.01]),
    )
    monkeypatch.setattr(late, "_told", lambda *_: told)
    finding = late.late_torque(arm, SimpleNamespace(), SimpleNamespace(strictness=1.0), 0.004)
    assert finding.refused is refused and "joint2 is 20 ms early" in finding.what
    assert ("unless something else" in finding.what) is not refused
