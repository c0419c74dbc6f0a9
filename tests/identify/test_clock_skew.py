"""The clocks of torque and position: a part of a sample is found with the parameters, a delay is left alone."""

import importlib
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import jaxswarm
from jaxswarm.effects.term import parse_terms
from jaxswarm.identify.synthetic import Noise, random_links, synthetic_log
from jaxswarm.robot.load import load_robot

_RATE = 125.0
_FRICTION = {"b": (0.8, 0.3, 0.1), "fc": (3.0, 1.5, 0.5)}


@pytest.fixture(scope="module")
def arm():
    bare = load_robot("rx60")
    return bare.replace(parameters=random_links(bare, np.random.default_rng(4)))


def _log(arm, late: float, seed: int = 5, early: float = 0.0):
    """A log whose torque is that of so many samples later, its dry friction of so many more."""
    terms = tuple(
        replace(term, values={p: _FRICTION[p][term.joint] for p in _FRICTION if p in names})
        for term in parse_terms("viscous_friction,coulomb_friction", arm.joints)
        for names in [[p.name for p in term.law.linear]]
    )
    fine = 40
    more = {"noise": Noise(0.0, 0.0), "duration": 16.0, "rate": fine * _RATE, "motion_seed": 1}
    log = synthetic_log(arm, terms, seed, **more)
    dry = log.tau - synthetic_log(arm, terms[: arm.num_joints], seed, **more).tau
    log = replace(log, tau=log.tau - dry + np.roll(dry, -round(early * fine), axis=0))
    first, moved = 10 * fine, round(late * fine)
    kept = slice(first, -first, fine)
    torque = slice(first + moved, len(log.t) - first + moved, fine)
    rng = np.random.default_rng(seed)
    q = log.q[kept] + 2e-5 * rng.normal(size=log.q[kept].shape)
    tau = log.tau[torque] + 0.05 * rng.normal(size=q.shape)
    return replace(log, t=log.t[kept] - log.t[first], q=q, tau=tau, channels={})


def _viscous(fitted):
    rows = [e for e in fitted["effects"] if e["effect"] == "viscous_friction"]
    return [e["parameters"]["b"]["value"] for e in rows]


@pytest.mark.parametrize("late", [0.4, -0.3])
def test_a_part_of_a_sample_is_found_with_the_rest(arm, late):
    fitted = jaxswarm.identify(_log(arm, late), arm, "viscous_friction,coulomb_friction")
    found = fitted["filtering"]["clock_skew_s"] * _RATE
    assert found == pytest.approx(-late, abs=0.03)
    np.testing.assert_allclose(_viscous(fitted), _FRICTION["b"], rtol=0.02, atol=0.01)


@pytest.mark.parametrize("late, early", [(0.0, 1.5), (0.4, 1.5), (0.0, -1.5)])
def test_friction_that_is_early_or_late_by_itself_is_no_matter_of_clocks(arm, late, early):
    """All of the torque together came out as early by a third of what friction was."""
    log = _log(arm, late, early=early)
    fitted = jaxswarm.identify(log, arm, "viscous_friction,coulomb_friction")
    assert fitted["filtering"]["clock_skew_s"] * _RATE == pytest.approx(-late, abs=0.05)


def test_a_long_log_tells_its_clocks_by_a_stretch_of_it(arm, monkeypatch):
    module = importlib.import_module("jaxswarm.identify.estimation.clock_skew")
    slopes = importlib.import_module("jaxswarm.identify.estimation.time_slopes")
    log, asked = _log(arm, 0.4), "viscous_friction,coulomb_friction"
    whole = jaxswarm.identify(log, arm, asked)["filtering"]["clock_skew_s"]
    for one in (module, slopes):
        monkeypatch.setattr(one, "MOST_ROWS", 150)
    monkeypatch.setattr(module, "_LONG", 200)
    fitted = jaxswarm.identify(log, arm, asked)
    assert fitted["filtering"]["clock_skew_s"] == pytest.approx(whole, abs=0.05 / _RATE)
    assert fitted["filtering"]["clock_skew_s"] != whole
    np.testing.assert_allclose(_viscous(fitted), _FRICTION["b"], rtol=0.05, atol=0.01)


def test_another_log_is_scored_by_the_same_clocks(arm):
    log, other = _log(arm, 0.4), _log(arm, 0.4, seed=6)
    fitted = jaxswarm.identify(
        log, arm, "viscous_friction,coulomb_friction", validation=replace(other, source="other")
    )
    errors = fitted["error"]["validation"]["rms"]
    assert max(errors) < 0.06


def test_clocks_that_agree_are_left(arm):
    fitted = jaxswarm.identify(_log(arm, 0.0), arm, "viscous_friction,coulomb_friction")
    assert abs(fitted["filtering"]["clock_skew_s"]) * _RATE < 0.02


def test_a_delay_of_samples_is_no_matter_of_clocks(arm):
    fitted = jaxswarm.identify(_log(arm, 3.0), arm, "viscous_friction,coulomb_friction")
    assert fitted["filtering"]["clock_skew_s"] == 0.0
    told = jaxswarm.identify(_log(arm, 3.0), arm, "viscous_friction,coulomb_friction,time_delay")
    assert told["filtering"]["clock_skew_s"] == 0.0
    delay = next(e for e in told["effects"] if e["effect"] == "time_delay")
    assert delay["parameters"]["seconds"]["value"] == pytest.approx(-3.0 / _RATE, rel=0.05)


@pytest.mark.parametrize("start", [0.0, 0.8e-3, 1.5e-3])
def test_clocks_end_where_they_fit_best_wherever_they_began(monkeypatch, start):
    """A step within its own doubt is a step towards the best place, too."""
    module = importlib.import_module("jaxswarm.identify.estimation.clock_skew")
    best, doubt = 1e-3, 1.5e-4

    def at(skew):
        motion = SimpleNamespace(skew=skew, weight_skew=0.0, interval=0.01)
        return SimpleNamespace(model=SimpleNamespace(terms=()), motions=(motion,))

    monkeypatch.setattr(module, "clock_skew", lambda one, _: (best - one.motions[0].skew, doubt))
    monkeypatch.setattr(module, "weight_step", lambda one: 0.0)

    def moved(one, late, heavy, bounded):
        return at(one.motions[0].skew + late)

    found = module.with_clocks(at(start), moved_by=moved)
    assert found.motions[0].skew == pytest.approx(best, abs=0.5 * doubt)


def test_no_skew_is_told_that_is_within_its_doubt(monkeypatch):
    module = importlib.import_module("jaxswarm.identify.estimation.clock_skew")
    motion = SimpleNamespace(skew=0.0, weight_skew=0.0, interval=0.01)
    found = SimpleNamespace(model=SimpleNamespace(terms=()), motions=(motion,))
    monkeypatch.setattr(module, "clock_skew", lambda one, _: (4e-4, 1.5e-4))
    monkeypatch.setattr(module, "weight_step", lambda one: 0.0)
    assert module.with_clocks(found) is found
