"""What fits clearly worse than waves of which no whole period is seen is no name; what shows it is told."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, added, declared_fit, diagnose_log, log_with, search_of

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.position_laws import is_unseen
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.report.result import to_result
from jaxswarm.diagnose.report.text import next_steps, verdict_sentence
from jaxswarm.diagnose.selection.outcome import outcome_of
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.unseen_order import worse_than_waves
from jaxswarm.effects.term import Term
from jaxswarm.logs.motion import prepare

WAVES, COMPENSATOR, SPRING = (
    Term(name, 1) for name in ("torque_ripple", "gravity_compensator", "joint_spring")
)


def ripple_log(part: float = 0.75):
    """A log whose second joint goes through a part of a period of a ripple of 3.6 N m."""
    way = float(np.ptp(prepare(log_with(), BAND).q[:, 1]))
    order = part * 2.0 * np.pi / way
    return log_with(Term("torque_ripple", 1, values={"sine": 3.0, "cosine": 2.0, "n": order}))


def asked_beside_waves(log, law: Term):
    """The selection with the waves refused, the law's score beside them, and its fit."""
    found, folds = declared_fit(log)
    waves, score = score_terms(Linearization(found, folds), [WAVES, law], 0)
    search = search_of(found)
    search.crossfit = folds
    search.unseen[1] = waves
    return search, score, refit_with(found, score)


def test_a_law_that_leaves_clearly_more_than_waves_is_refused_with_them():
    search, score, after = asked_beside_waves(ripple_log(), COMPENSATOR)
    assert is_unseen(search.unseen[1].candidate.term, search.current.motions)
    assert "no whole period" in worse_than_waves(search, score, after)
    ((law, waves, period),) = search.outdone
    assert law.effect == "gravity_compensator" and "a" in law.values
    assert waves.values["n"] == pytest.approx(3.3, rel=0.05)
    assert period == pytest.approx(1.9, rel=0.05)
    search.ask_again(1)  # beside another model they are other waves
    assert worse_than_waves(search, score, after) is None


@pytest.mark.parametrize(
    "true",
    [
        Term("joint_spring", 1, values={"k": 5.0, "tau0": 2.0}),
        Term("gravity_compensator", 1, values={"a": 5.0, "b": 0.7, "q0": 0.2}),
    ],
    ids=lambda t: t.effect,
)
def test_the_law_that_the_joint_has_stands_beside_waves_that_imitate_it(true):
    search, score, after = asked_beside_waves(log_with(true), Term(true.effect, 1))
    assert search.unseen[1].share > 0.2
    assert worse_than_waves(search, score, after) is None


def test_neither_is_added_and_how_far_to_move_is_told():
    """Nothing was told of either, or the compensator was added where it left less than twice the noise."""
    found = diagnose_log(ripple_log())
    assert added(found) == []
    result = to_result(outcome_of(found))
    assert result["verdict"] == "unexplained"
    (pair,) = result["undecided"]
    assert pair["joint"] == "joint2"
    assert pair["effects"] == ["torque_ripple", "gravity_compensator"]
    assert pair["experiment"].startswith("move joint2 over more than 1.9, a whole period")
    named = "torque_ripple or gravity_compensator on joint2"
    assert named in verdict_sentence(result)
    assert any("move joint2 over more than" in step for step in next_steps(result))
    # A law that was refused so and stands beside what came later is one that was added.
    kept = (found.outdone[0]._replace(law=Term("coulomb_friction", 1)),)
    assert to_result(outcome_of(replace(found, outdone=kept)))["undecided"] == []
