"""Beside an event that was found further ones are added at once, unless a law of their joint tells them."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, blank, log_with, small_arm

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.budget import Budget
from jaxswarm.diagnose.selection.further import add_further
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

LAWS = [Term("thermal_drift", 1), Term("quadratic_drag", 1)]
FIRST = Term("contact", values={"start": 9.0, "end": 9.5, "log": 0.0})


def further(extra):
    """Events that are added beside a known push, with a torque (T,) on joint 2 [N m] where laws were asked."""
    log = log_with(duration=30.0)
    push = 6.0 * ((log.t > 9.0) & (log.t < 9.5))
    tau = log.tau + np.stack([0.0 * log.t, push + extra(log)], 1)
    motion = prepare(replace(log, tau=tau), BAND)
    found = with_motion_noise(estimate(small_arm(), (*blank(), FIRST), [motion], bounded=False))
    rules = Rules()
    search = Search(
        found, found, rules, 0, Memory(None, rules.share), (), lambda text: None, Budget(), asked=60
    )
    search.scores = score_terms(Linearization(found, cross_fit(found)), LAWS, 0)
    add_further(search, Term("contact"), 3)
    return [(s.added.values["start"], s.added.values["end"]) for s in search.steps]


def warming(log):
    """Friction that falls as the drive warms up [N m]."""
    return 2.0 * np.exp(-log.t / 6.0) * np.sign(np.gradient(log.q[:, 1], log.t))


def test_friction_that_falls_is_not_told_as_pushes_up_and_down():
    assert further(warming) == []


def test_a_second_push_is_added():
    ((start, end),) = further(lambda log: -5.0 * ((log.t > 20.0) & (log.t < 20.6)))
    assert (start, end) == (pytest.approx(20.0, abs=0.1), pytest.approx(20.6, abs=0.1))
