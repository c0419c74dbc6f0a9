"""A zero of the torque that wanders is told from one that is off, from friction that warms and from loads."""

import pytest
from elbow import ask, elbow_log, fitted, passing

from jaxswarm.diagnose.decision.competing import choose
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.effects.term import Term

RIVALS = (
    *("torque_offset", "thermal_drift", "friction_change", "payload_change", "contact"),
    *("joint_spring", "cable_coupling", "quadratic_drag"),
)


def chosen(*hidden: Term):
    """What is chosen among all that may be taken for a drift, its rivals, and the fit with it."""
    found = fitted(elbow_log(*hidden))
    passed = passing(ask(found, "offset_drift", *RIVALS))
    best, rivals = choose(passed, Rules(), cross_fit(found))
    return best.candidate.term, [s.candidate.term.effect for s in rivals], refit_with(found, best)


@pytest.mark.parametrize(("joint", "tau", "tc"), [(0, 1.0, 4.0), (1, -1.0, 4.0), (2, 0.6, 2.0)])
def test_a_zero_that_wanders_is_named_with_its_size_and_its_time(joint, tau, tc):
    term, rivals, after = chosen(Term("offset_drift", joint, values={"tau": tau, "tc": tc}))
    assert not rivals
    term = find_term(after, term)
    assert term.place == ("offset_drift", joint, None)
    assert term.values["tau"] == pytest.approx(tau, rel=0.15)
    assert term.values["tc"] == pytest.approx(tc, rel=0.3)


@pytest.mark.parametrize(
    "hidden",
    [
        Term("torque_offset", 0, values={"tau0": 1.0}),
        Term("thermal_drift", 1, values={"fc": 2.0, "tc": 4.0}),
        Term("joint_spring", 1, values={"k": 3.0, "tau0": 0.5}),
    ],
)
def test_what_does_not_wander_is_no_drift(hidden):
    term, rivals, after = chosen(hidden)
    assert term.place == hidden.place and not rivals
    assert not passing(ask(after, "offset_drift"))
