"""What explains a small part of what a joint lacks is no name for it; what explains the rest stays."""

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
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import Step, find_term
from jaxswarm.diagnose.selection.take_back import take_back_shadows
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

OFFSET = Term("torque_offset", 1)


def searched(unknown: float) -> Search:
    """As if an offset of 1.5 N m had been added, with a wave of no known law of so many N m beside it."""
    log = log_with(replace(OFFSET, values={"tau0": 1.5}))
    tau = log.tau.copy()
    tau[:, 1] += unknown * np.sin(7.3 * log.t) * np.sin(3.1 * log.t**1.5)
    motion = prepare(replace(log, tau=tau), BAND)
    before = with_motion_noise(estimate(small_arm(), blank(), [motion], bounded=False))
    crossfit = cross_fit(before)
    (score,) = score_terms(Linearization(before, crossfit), [OFFSET], 0)
    after = with_motion_noise(refit_with(before, score))
    step = Step(find_term(after, OFFSET), score, (), (), before, after, ())
    search = Search(after, before, Rules(), 0, Memory(), (), lambda text: None, Budget())
    search.steps, search.crossfit = [step], cross_fit(after)
    return search


def test_what_explains_all_that_is_missing_stays():
    search = searched(0.0)
    take_back_shadows(search)
    assert [s.added.effect for s in search.steps] == ["torque_offset"] and not search.refused


def test_a_small_part_of_what_is_missing_is_taken_back_and_told():
    search = searched(12.0)
    take_back_shadows(search)
    assert not search.steps
    assert OFFSET.identity not in {t.identity for t in search.current.model.terms}
    ((term, why),) = search.refused
    assert term.effect == "torque_offset"
    assert "squared error of joint2" in why and "times its noise" in why


def test_a_large_part_stays_though_more_is_missing():
    search = searched(1.0)
    left = search.current.fit.sigma[1] / search.crossfit.noise[1]
    assert left > 2.0
    take_back_shadows(search)
    assert [s.added.effect for s in search.steps] == ["torque_offset"]


@pytest.mark.parametrize("unknown", [0.0, 12.0])
def test_the_folds_are_those_of_the_model_that_is_left(unknown):
    search = searched(unknown)
    take_back_shadows(search)
    np.testing.assert_allclose(search.crossfit.noise, cross_fit(search.current).noise)
