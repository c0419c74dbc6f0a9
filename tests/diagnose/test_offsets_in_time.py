"""A torque's zero that wanders or jumps is told from one that is off, from friction and from loads."""

import pytest
from elbow import ask, elbow_log, fitted, passing

from jaxswarm.diagnose.decision.competing import choose
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.effects.term import Term

RIVALS = (
    *("offset_drift", "offset_change", "torque_offset", "thermal_drift", "friction_change"),
    *("payload_change", "contact", "joint_spring", "cable_coupling", "quadratic_drag"),
)


def chosen(*hidden: Term):
    """What is chosen among all that may be taken for a drift, its rivals, and the fit with it."""
    found = fitted(elbow_log(*hidden))
    passed = passing(ask(found, *RIVALS))
    best, rivals = choose(passed, Rules(), cross_fit(found))
    return best.candidate.term, [s.candidate.term.effect for s in rivals], refit_with(found, best)


@pytest.mark.parametrize(("joint", "tau", "tc"), [(0, 1.0, 4.0), (1, -1.0, 4.0), (2, 0.6, 2.0)])
def test_a_zero_that_wanders_is_named_with_its_size_and_its_time(joint, tau, tc):
    term, rivals, after = chosen(Term("offset_drift", joint, values={"rate": tau / tc, "tc": tc}))
    assert not rivals
    term = find_term(after, term)
    assert term.place == ("offset_drift", joint, None)
    assert term.values["rate"] * term.values["tc"] == pytest.approx(tau, rel=0.15)
    assert term.values["tc"] == pytest.approx(tc, rel=0.3)


@pytest.mark.parametrize(("joint", "tau", "t0"), [(0, 1.0, 7.3), (1, -1.5, 6.1)])
def test_a_zero_that_jumps_is_named_with_its_size_and_its_time(joint, tau, t0):
    """One that jumped by a newton meter was told as a drift and a base that is tilted."""
    term, rivals, after = chosen(Term("offset_change", joint, values={"tau": tau, "t0": t0}))
    assert not rivals
    term = find_term(after, term)
    assert term.place == ("offset_change", joint, None)
    assert term.values["tau"] == pytest.approx(tau, rel=0.15)
    assert term.values["t0"] == pytest.approx(t0, abs=0.1)


@pytest.mark.parametrize(
    "hidden",
    [
        Term("torque_offset", 0, values={"tau0": 1.0}),
        Term("thermal_drift", 1, values={"fc": 2.0, "tc": 4.0}),
        Term("friction_change", 1, values={"fc": 1.5, "t0": 6.0}),
        Term("joint_spring", 1, values={"k": 3.0, "tau0": 0.5}),
    ],
)
def test_what_neither_wanders_nor_jumps_is_told_as_neither(hidden):
    term, rivals, after = chosen(hidden)
    assert term.place == hidden.place and not rivals
    assert not passing(ask(after, "offset_drift", "offset_change"))
