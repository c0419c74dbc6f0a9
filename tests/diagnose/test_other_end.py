"""What a cable over two joints does to the partner is asked as soon as one of its ends is found."""

import pytest
from planted import BAND, blank, log_with, small_arm

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.selection.budget import Budget
from jaxswarm.diagnose.selection.further import add_further
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

ENDS = (
    Term("cable_coupling", 0, 1, values={"k": 6.0, "kc": -8.0, "tau0": 1.0}),
    Term("cable_coupling", 1, 0, values={"k": 10.7, "kc": -8.0, "tau0": -1.3}),
)


def with_one_end(*hidden: Term) -> Search:
    """A search on a log that holds hidden terms, which has found what pulls at the second joint."""
    found = estimate(
        small_arm(), (*blank(), Term("cable_coupling", 1, 0)), [prepare(log_with(*hidden), BAND)],
        bounded=False,
    )  # fmt: skip
    rules = Rules()
    return Search(
        found, found, rules, 0, Memory(None, rules.share), (), lambda text: None, Budget(), asked=60
    )


def test_the_other_end_is_added_with_the_stiffness_of_the_first():
    search = with_one_end(*ENDS)
    before = search.current.fit.sigma
    add_further(search, Term("cable_coupling", 0, 1), 1)
    (step,) = search.steps
    assert step.added.place == ENDS[0].place
    assert step.added.values["kc"] == pytest.approx(-8.0, rel=0.05)
    assert (search.current.fit.sigma < 0.3 * before).all()


def test_no_other_end_is_added_where_the_partner_feels_nothing():
    search = with_one_end(ENDS[1])
    add_further(search, Term("cable_coupling", 0, 1), 1)
    assert not search.steps


def test_an_end_that_is_there_is_not_asked_again():
    search = with_one_end(*ENDS)
    add_further(search, Term("cable_coupling", 1, 0), 1)
    assert not search.steps
