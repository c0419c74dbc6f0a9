"""Laws that one log hardly tells apart, told apart by another; and what nothing can tell."""

import importlib
from types import SimpleNamespace

import pytest
from planted import BAND, declared_fit, log_with

from jaxswarm.diagnose.decision.evaluate import score_on
from jaxswarm.diagnose.selection import holds as holding
from jaxswarm.diagnose.selection import refit as refitting
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.effects.term import Term
from jaxswarm.logs.motion import prepare

rivals_module = importlib.import_module("jaxswarm.diagnose.selection.rivals_elsewhere")
survives_module = importlib.import_module("jaxswarm.diagnose.selection.survives")


def score(effect: str, joint: int = 0):
    return SimpleNamespace(name=effect, joint=joint)


@pytest.mark.parametrize(
    ("left", "best", "kept"),
    [
        ({"power": 0.80, "stribeck": 0.60}, "stribeck", []),
        ({"power": 0.80, "stribeck": 0.78}, "power", ["stribeck"]),
        ({"power": 0.60, "stribeck": 0.80}, "power", []),
        ({"power": 0.80, "stribeck": None}, "power", []),
    ],
)
def test_the_error_of_other_motion_decides_where_it_differs(monkeypatch, left, best, kept):
    """By a twentieth at least, and a rival that is clearly worse there is none; one without a fit neither."""
    monkeypatch.setattr(
        rivals_module, "refit_with", lambda current, s: s.name if left[s.name] else None
    )
    monkeypatch.setattr(rivals_module, "left_elsewhere", lambda fit, *a: left[fit])
    power, stribeck = score("power"), score("stribeck")
    chosen, after, rivals = rivals_module.best_elsewhere(
        None, power, "power", [stribeck], [stribeck], ["log"]
    )
    assert chosen.name == after == best
    assert [s.name for s in rivals] == kept


@pytest.mark.parametrize(
    ("hidden", "told"),
    [
        (Term("joint_spring", 1, values={"k": 6.0, "tau0": 2.0}), True),
        (Term("torque_offset", 1, values={"tau0": 6.0}), False),
    ],
)
def test_other_motion_tells_a_law_from_what_it_contains(monkeypatch, hidden, told):
    """A spring that its own log did not tell from a constant torque came out as one on a lever."""
    current, _ = declared_fit(log_with(hidden))
    other = [prepare(log_with(hidden, seed=2, motion_seed=8), BAND)]
    (spring,) = score_on(current, [Term("joint_spring", 1)], 0)
    monkeypatch.setattr(holding, "goes_beyond", lambda *_: False)  # the log's own doubt
    assert refitting.refit_with(current, spring) is None
    after = rivals_module.told_elsewhere(current, spring, other)
    assert (after is not None) is told
    assert rivals_module.told_elsewhere(current, spring, []) is None


def test_what_no_part_of_a_log_can_show_is_not_added(monkeypatch):
    """No second log, no region and no stretch of time that the rest predicts."""
    robot = SimpleNamespace(joints=("joint1",))
    fit = SimpleNamespace(model=SimpleNamespace(robot=robot))
    monkeypatch.setattr(survives_module, "unconfirmed", lambda *a: None)
    monkeypatch.setattr(survives_module, "noise_of", lambda found: None)
    monkeypatch.setattr(survives_module, "on_stretches", lambda *a: (False, False))
    monkeypatch.setattr(survives_module, "errors_elsewhere", lambda *a: iter(()))
    assert "record another motion" in survives_module.survives(fit, fit, 0)
    monkeypatch.setattr(survives_module, "on_stretches", lambda *a: (True, False))
    assert survives_module.survives(fit, fit, 0) is None
    monkeypatch.setattr(survives_module, "on_stretches", lambda *a: (True, True))
    assert "stretches" in survives_module.survives(fit, fit, 0)


def test_an_event_is_found_again_though_its_fit_moved_it():
    """Its identity holds the begin, rounded; of several events the nearest is meant."""
    asked = Term("payload_change", values={"start": 0.914, "end": 9.5, "log": 0.0})
    moved = Term("payload_change", values={"start": 1.19, "end": 9.4, "log": 0.0})
    later = Term("payload_change", values={"start": 4.0, "end": 6.0, "log": 0.0})
    other = Term("torque_offset", 0)
    assert asked.identity != moved.identity
    found = SimpleNamespace(model=SimpleNamespace(terms=(other, later, moved)))
    assert find_term(found, asked) is moved
    assert find_term(found, other) is other
