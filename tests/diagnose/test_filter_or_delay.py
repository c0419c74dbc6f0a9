"""A filter is told from a delay by which leaves less, however little that is, and both where neither does."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from elbow import ask, elbow, elbow_log, fitted
from planted import BAND

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.decision.competing import accepted
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.budget import Budget
from jaxswarm.diagnose.selection.readings import why_not, with_readings
from jaxswarm.diagnose.selection.refit import refit_in_place, refit_with
from jaxswarm.diagnose.selection.stand import in_all_motion
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import find_term, step_between
from jaxswarm.diagnose.selection.tenable import is_certain
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import Noise, synthetic_log
from jaxswarm.logs.motion import prepare

FILTER = Term("torque_lag", values={"tc": 0.02, "seconds": 0.0})
DELAY = Term("time_delay", values={"seconds": 0.012})


@cache
def told_as_delay(truth: str) -> Search:
    """A selection that added a delay to a log of a filter or of a delay."""
    return delay_added(fitted(elbow_log(FILTER if truth == "filter" else DELAY)))


def delay_added(found) -> Search:
    """A selection that has added a delay to a fit."""
    (delay,) = ask(found, "time_delay")
    after = refit_with(found, delay)
    search = Search(after, found, Rules(), 0, Memory(), (), lambda text: None, Budget())
    search.crossfit = cross_fit(after)
    search.steps = [step_between(delay, found, after)]
    return search


def asked_small(search: Search):
    """The score of the filter beside the delay, as certain as need be and too small for an effect."""
    (lag,) = ask(search.current, "torque_lag")
    return replace(lag, p_value=1e-4, share=0.1, repeats=1.0, over_noise=0.2, allowed=True)


def test_a_filter_that_takes_little_off_beside_a_delay_is_told_in_its_place():
    search = told_as_delay("filter")
    small = asked_small(search)
    assert accepted([small], Rules(), search.added) == [small]
    assert not accepted([small], Rules())
    after = refit_with(search.current, small)
    assert why_not(search, small, after) is None
    assert find_term(after, FILTER).values["seconds"] == 0.0
    assert find_term(after, FILTER).values["tc"] == pytest.approx(0.02, rel=0.02)


def test_a_delay_is_not_told_as_a_filter_that_is_late_as_well():
    search = told_as_delay("delay")
    small = asked_small(search)
    after = refit_in_place(search.current, replace(FILTER, values={"tc": 0.01, "seconds": 0.0}))
    assert find_term(after, FILTER).values["seconds"] == pytest.approx(0.012, abs=0.002)
    assert why_not(search, small, after) == ""


def test_a_filter_beside_a_delay_is_tested_in_dry_friction_as_it_passed():
    """A hundred others that were asked in the round made it seem to show in dry friction alone."""
    search = replace(told_as_delay("filter"))
    (lag,) = ask(search.current, "torque_lag")
    others = ask(search.current, "joint_spring")
    search.scores = [lag, *(others[0] for _ in range(10**6))]
    search.rules = replace(Rules(), significance=1e4 * lag.p_value)
    assert in_all_motion(search, [lag]) == [lag]


@pytest.mark.parametrize(("noise", "undecided"), [(0.1, False), (8.0, True)])
def test_a_delay_is_undecided_from_a_filter_where_noise_hides_which_it_is(noise, undecided):
    friction = tuple(
        replace(t, values={"b": 2.0, "fc": 2.0})
        for t in parse_terms("viscous_friction,coulomb_friction", elbow().joints)
    )
    late = replace(DELAY, values={"seconds": 0.02})
    log = synthetic_log(
        elbow(), (*friction, late), 1, noise=Noise(2e-5, noise), duration=12.0, rate=125.0
    )
    declared = tuple(replace(t, values={}) for t in friction)
    search = delay_added(estimate(elbow(), declared, [prepare(log, BAND)], bounded=False))
    with_readings(search)
    told = [s.candidate.term.effect for s in search.steps[0].rivals]
    assert told == ["torque_lag"] * undecided


def test_what_is_held_where_it_does_nothing_makes_no_law_certain():
    hardly = replace(FILTER, values={"tc": 0.001, "seconds": 0.0})
    assert not is_certain(hardly, {"tc": 0.001, "seconds": np.nan})
    assert is_certain(FILTER, {"tc": 0.001, "seconds": np.nan})
