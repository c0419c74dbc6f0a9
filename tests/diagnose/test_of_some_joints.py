"""Laws of some joints are asked alone, and told as they would be among all."""

import pytest
from planted import BAND, blank, log_with, search_of, small_arm

from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.decision.competing import accepted
from jaxswarm.diagnose.decision.evaluate import score_on
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.selection import of_some_joints
from jaxswarm.diagnose.selection.of_some_joints import accepted_on
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare


@pytest.mark.parametrize(
    "truth",
    [
        Term("joint_spring", 1, values={"k": 25.0, "tau0": 2.0}),
        Term("time_delay", values={"seconds": 0.015}),
    ],
    ids=lambda t: t.effect,
)
@pytest.mark.parametrize("joint", [0, 1])
def test_those_that_show_there_are_the_same_as_among_all(truth, joint, monkeypatch):
    motion = prepare(log_with(truth), BAND)
    found = with_motion_noise(estimate(small_arm(), blank(), [motion], bounded=False))
    search = search_of(found)
    asked = []

    def counted(lin, terms, seed):
        asked.extend(terms)
        return score_terms(lin, terms, seed)

    score_terms = of_some_joints.score_terms
    monkeypatch.setattr(of_some_joints, "score_terms", counted)
    told, _ = accepted_on(search, found, {joint}, search.memory)
    every = eligible_terms(found.model, found.motions)
    among = accepted(score_on(found, every, search.seed), search.rules, ())
    here = [s for s in among if s.joint == joint or s.candidate.term.joint is None]
    assert {s.candidate.term.place for s in told} == {s.candidate.term.place for s in here}
    assert len(asked) < 0.75 * len(every)
