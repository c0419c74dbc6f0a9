"""Friction that falls as a joint warms is told where the friction of before holds the joint at rest."""

from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest
from planted import BAND, blank, small_arm
from test_standing import stopping

from jaxswarm.diagnose import diagnose
from jaxswarm.diagnose.decision.remainder import remainders
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.standing import held_shares
from jaxswarm.logs.motion import prepare

module = import_module("jaxswarm.diagnose.selection.state_events")

DRIFT = {"fc": 3.0, "tc": 6.0}


@pytest.fixture(scope="module")
def found():
    """More is left in motion than a rest beside friction alone would be left with, by 2.5 times."""
    log = stopping(2.0, 0, Term("thermal_drift", 0, values=DRIFT))
    return diagnose(small_arm(), blank(), [prepare(log, BAND)])


def test_the_law_is_told_and_rest_left_out(found):
    """It took 29 % off, as rest stayed in at 10 times the noise, and was taken back."""
    assert [(s.added.effect, s.added.joint) for s in found.kept] == [("thermal_drift", 0)]
    for name, value in DRIFT.items():
        assert found.kept[0].added.values[name] == pytest.approx(value, rel=0.03)
    assert held_shares(found.final.motions)["joint1"] > 0.4
    assert all(r.over_noise < 1.0 for r in remainders(found.final))


@pytest.mark.parametrize(("sticks", "none"), [({0}, True), ({1}, False)])
def test_an_event_told_by_a_rest_that_is_left_out_by_now_is_none(found, monkeypatch, sticks, none):
    final = found.final
    held = ~final.regression.used_rows[:, 0]
    rows = np.flatnonzero(held)
    end = rows[np.argmax(np.diff(rows) > 1)]
    begin, last = (float(final.regression.t[k]) for k in (rows[0], end))
    pushed = {"tau_joint1": 1e3, "tau_joint2": 0.0}  # more than any rest is left with
    event = Term("contact", values={"start": begin, "end": last, "log": 0.0, **pushed})
    step = SimpleNamespace(added=event, score=SimpleNamespace(joint=0))
    search = SimpleNamespace(current=final, steps=[step], sticking=sticks)
    monkeypatch.setattr(module, "with_errors", lambda added, current: (added, {}))
    monkeypatch.setattr(module, "is_certain", lambda term, errors: True)
    told = module.event_of_nothing(search)
    assert (told is not None) is none
    if none:
        assert "dry friction holds joint1" in told[1]
