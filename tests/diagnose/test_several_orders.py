"""Ripples of several orders on one joint: a motor's cogging and its multiples, the teeth of a gear."""

import pytest
from planted import added, diagnose_log, log_with, small_arm

from jaxswarm.diagnose.report.text import grouped
from jaxswarm.effects import REGISTRY
from jaxswarm.effects.alike import number_of, without
from jaxswarm.effects.term import Term

ORDERS = {17.0: 1.4, 34.0: 0.7}


@pytest.fixture(scope="module")
def found():
    terms = [
        Term("torque_ripple", 0, values={"sine": a, "cosine": 0.3, "n": n})
        for n, a in ORDERS.items()
    ]
    return diagnose_log(log_with(*terms, duration=20.0))


def test_each_order_is_added_with_its_own_values(found):
    assert added(found) == [("torque_ripple", 0)] * 2
    ripples = [t for t in found.final.model.terms if t.effect == "torque_ripple"]
    got = {round(t.values["n"]): t.values["sine"] for t in ripples}
    assert got == pytest.approx(ORDERS, rel=0.05)
    assert (found.final.fit.sigma < 0.1).all()


def test_columns_and_results_tell_them_apart(found):
    names = [n for t in found.final.model.terms for n in t.columns(small_arm().joints)]
    assert len(set(names)) == len(names)


def test_a_sentence_tells_their_orders():
    told = [
        {"effect": "torque_ripple", "joint": "j1", "way": REGISTRY["torque_ripple"].way({"n": n})}
        for n in ORDERS
    ]
    assert (
        grouped(told, ["j1", "j2"])
        == "torque_ripple (order 17) on j1, torque_ripple (order 34) on j1"
    )


def test_one_of_them_is_left_out_though_a_fit_has_moved_it():
    terms = tuple(Term("torque_ripple", 0, values={"n": n}) for n in (9.04, 18.0))
    moved = Term("torque_ripple", 0, values={"n": 9.06})
    assert moved.identity != terms[0].identity
    assert number_of(moved, terms) == 0
    assert [t.values["n"] for t in without(moved, terms)] == [18.0]
