"""An addition is asked again beside its competitors, each of them once."""

from types import SimpleNamespace

import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.selection.step import competitors
from jaxswarm.effects.term import Term


def near(term):
    return SimpleNamespace(candidate=SimpleNamespace(term=term))


def test_one_that_came_in_the_place_of_another_is_no_competitor_of_itself():
    """A play was told as undecided between itself and itself, or the diagnosis ended with a traceback."""
    play, spring = Term("backlash", 3, values={"gap": 0.002}), Term("joint_elasticity", 3)
    step = SimpleNamespace(
        added=Term("backlash", 3, values={"gap": 0.001}), rivals=(near(play),), near=(near(spring),)
    )
    assert competitors(step) == [spring]
    push = SimpleNamespace(
        added=Term("contact", values={"start": 1.0}),
        rivals=(near(Term("contact", values={"start": 5.0})),),
        near=(),
    )
    assert competitors(push) == []


def test_scores_are_told_apart_by_which_they_are():
    """Of two scores of one candidate the arrays were compared, which have no truth."""
    candidate = Candidate(Term("backlash", 3), (), 2)

    def scored():
        return Score(
            candidate, 1.0, np.ones(2), np.ones(4), 0.5, 0.5, 0, 1e-9, 1.0, np.ones(1), True
        )

    one, other = scored(), scored()
    assert one in [one] and one not in [other]
