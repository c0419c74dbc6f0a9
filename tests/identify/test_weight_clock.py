"""The weight has a clock of its own where a slower computer tells it, on several joints alike."""

import importlib
import json
from dataclasses import replace

import numpy as np
import pytest

import jaxswarm
from jaxswarm.identify.forward.columns import torque_of
from jaxswarm.identify.forward.model import load_model
from jaxswarm.identify.synthetic import Noise, random_links, synthetic_log
from jaxswarm.robot.load import load_robot

_RATE, _EARLY, _NOISE = 50.0, 0.4, 0.02


@pytest.fixture(scope="module")
def arm():
    bare = load_robot("rx60")
    return bare.replace(parameters=random_links(bare, np.random.default_rng(4)))


def _log(arm, joints=(0, 1, 2), seed: int = 5, motion: int = 1):
    """A log of the arm with the weight on some joints read a part of a sample before all other torque."""
    fine = 40
    more = {"noise": Noise(0.0, 0.0), "duration": 16.0, "rate": fine * _RATE, "motion_seed": motion}
    log = synthetic_log(arm, (), seed, **more)
    rest, pi = np.zeros_like(log.q), np.asarray(arm.parameters).ravel()
    weight = torque_of(arm, log.q, rest, rest, pi)
    kept, later = slice(10 * fine, -10 * fine, fine), np.roll(weight, -round(_EARLY * fine), axis=0)
    tau, own = np.array(log.tau), list(joints)
    tau[:, own] += (later - weight)[:, own]
    rng = np.random.default_rng(seed)
    tau = tau[kept] + _NOISE * rng.normal(size=log.q[kept].shape)
    return replace(log, t=log.t[kept] - log.t[10 * fine], q=log.q[kept], tau=tau, channels={})


def _clocks(fitted):
    told = fitted["filtering"]
    return told["weight_skew_s"] * _RATE, told["clock_skew_s"] * _RATE


def test_the_weight_is_moved_and_nothing_else(arm):
    """Taken for the clock of all torque it would move what carries no weight, as well."""
    fitted = jaxswarm.identify(_log(arm), arm)
    weight, whole = _clocks(fitted)
    assert weight == pytest.approx(-_EARLY, abs=0.03)
    assert whole == pytest.approx(0.0, abs=0.03)
    assert max(fitted["residual_std"]) < 1.2 * _NOISE
    assert any("The weight is read 8." in line for line in fitted.lines)


def test_what_one_joint_says_alone_is_no_clock_of_the_weight(arm):
    assert _clocks(jaxswarm.identify(_log(arm, joints=(1,)), arm))[0] == 0.0


def test_weight_that_is_told_with_the_rest_has_no_clock(arm):
    assert _clocks(jaxswarm.identify(_log(arm, joints=()), arm))[0] == 0.0


def test_a_long_log_tells_it_by_a_stretch_of_it(arm, monkeypatch):
    clocks, slopes = (
        importlib.import_module(f"jaxswarm.identify.estimation.{name}")
        for name in ("clock_skew", "time_slopes")
    )
    for module in (clocks, slopes):
        monkeypatch.setattr(module, "MOST_ROWS", 150)
    monkeypatch.setattr(clocks, "_LONG", 200)
    weight, _ = _clocks(jaxswarm.identify(_log(arm), arm))
    assert weight == pytest.approx(-_EARLY, abs=0.1)


def test_other_motion_is_predicted_by_it_from_a_file(arm, tmp_path):
    fitted = jaxswarm.identify(_log(arm), arm, validation=_log(arm, seed=6, motion=2))
    assert max(fitted["error"]["validation"]["rms"]) < 1.5 * _NOISE
    fitted.save(tmp_path / "model.json")
    other = _log(arm, seed=7, motion=3)
    left = other.tau - jaxswarm.predict(tmp_path / "model.json", other).tau
    inside = slice(25, -25)
    assert np.sqrt((left[inside] ** 2).mean(axis=0)).max() < 1.5 * _NOISE


def test_files_from_before_lack_it_and_are_read(arm, tmp_path):
    jaxswarm.identify(_log(arm), arm).save(tmp_path / "model.json")
    content = json.loads((tmp_path / "model.json").read_text())
    del content["filtering"]["weight_skew"]
    (tmp_path / "older.json").write_text(json.dumps(content))
    assert load_model(tmp_path / "older.json").filtering.weight_skew == 0.0
