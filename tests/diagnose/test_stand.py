"""An event that a law of the motion tells from other times is none, proven or not; a push stays one."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, blank, log_with, search_of, small_arm

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.stand import events_of_laws, that_may_stand
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

ASKED = [Term("contact"), Term("position_dependent_friction", 1), Term("quadratic_drag", 1)]


def events_that_are_none(extra):
    """Events that laws of the motion tell, and whether there was one, with a torque (T,) on joint 2 [N m]."""
    log = log_with(duration=30.0)
    tau = log.tau + np.stack([0.0 * log.t, extra(log)], 1)
    motion = prepare(replace(log, tau=tau), BAND)
    found = with_motion_noise(estimate(small_arm(), blank(), [motion], bounded=False))
    folds = cross_fit(found)
    scores = score_terms(Linearization(found, folds), ASKED, 0)
    events = [s for s in scores if s.candidate.term.effect == "contact" and s.gain > 0]
    return events_of_laws(scores, events, folds, Rules()), events


def speed(log):
    return np.gradient(log.q[:, 1], log.t)


def push(log):
    return 6.0 * ((log.t > 9.0) & (log.t < 9.5))


def by_place(log):
    """Friction by the position [N m]."""
    return 4.0 * np.sign(speed(log)) * np.sin(log.q[:, 1])


@pytest.mark.parametrize(("way", "stands"), [(1e-4, False), (0.02, True)])
def test_bristles_of_the_least_way_there_is_are_not_fitted(way, stands):
    """They are friction that holds a joint: each of 25 fits came to nothing, some after 15 s."""
    asked = Term("hysteresis", 1)
    log = prepare(log_with(replace(asked, values={"fc": 4.0, "x0": 0.05})), BAND)
    found = with_motion_noise(estimate(small_arm(), blank(), [log]))
    search = search_of(found, crossfit=cross_fit(found))
    (score,) = score_terms(Linearization(found, search.folds), [asked], 0)
    placed = replace(score.candidate, term=replace(asked, values={"x0": way}))
    left = that_may_stand(search, [replace(score, candidate=placed)])
    assert bool(left) == stands
    assert search.is_refused(asked) == (not stands) and not search.refused


def test_a_window_that_a_law_tells_from_other_times_is_no_event():
    """Where friction by the position is largest, a push is what explains most of so short a time."""
    none, events = events_that_are_none(by_place)
    assert events and none == events


def test_a_push_stays_an_event_beside_a_law_that_explains_more():
    """The law takes off what the rest of the log has, and does not tell the push."""
    none, events = events_that_are_none(lambda log: push(log) + by_place(log))
    assert events and not none
