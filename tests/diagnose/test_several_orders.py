"""Ripples of several orders on one joint: a motor's cogging and its multiples, the teeth of a gear."""

from types import SimpleNamespace

import numpy as np
import pytest
from planted import added, diagnose_log, log_with, small_arm

from jaxswarm.diagnose.candidates.position_laws import is_unseen, leaves_room, strays
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


def test_a_sentence_counts_the_logs_that_have_one_of_their_own():
    told = [{"effect": "periodic_force", "joint": joint} for joint in ("j1", "j1", "j2")]
    assert grouped(told, ["j1", "j2", "j3"]) == "periodic_force on j1 in 2 logs and j2"


@pytest.mark.parametrize(
    ("way", "order", "strays_there"),
    [(2.3, 14.05, False), (2.3, 10.4, True), (2.3, 7.2, True), (4.0, 10.4, False)],
)
def test_beside_an_order_seen_through_few_periods_only_its_multiples_may_stand(
    way, order, strays_there
):
    """Order 7 goes through 2.6 periods on 2.3 rad, 4.5 on 4 rad."""
    held = [Term("torque_ripple", 0, values={"n": 7.0}), Term("joint_spring", 0)]
    motion = SimpleNamespace(q=np.array([[0.0, 0.0], [way, 0.0]]))
    asked = Term("torque_ripple", 0, values={"n": order})
    assert strays(asked, held, [motion]) is strays_there
    assert not strays(Term("torque_ripple", 1, values={"n": order}), held, [motion])
    assert leaves_room(held[0], [motion]) and not leaves_room(held[1], [motion])


@pytest.mark.parametrize(("way", "unseen"), [(0.8, True), (1.6, False)])
def test_an_order_of_which_no_whole_period_is_seen_is_a_bend(way, unseen):
    """On a measured arm a ripple was told of 4.2 +- 1.7 periods a turn, on 0.8 rad."""
    motion = SimpleNamespace(q=np.array([[0.0], [way]]))
    assert is_unseen(Term("torque_ripple", 0, values={"n": 4.2}), [motion]) is unseen
    assert not is_unseen(Term("joint_spring", 0), [motion])


def test_few_periods_leave_no_room_at_all():
    motion = SimpleNamespace(q=np.array([[0.0], [1.5]]))
    assert not leaves_room(Term("torque_ripple", 0, values={"n": 7.0}), [motion])


def test_one_of_them_is_left_out_though_a_fit_has_moved_it():
    terms = tuple(Term("torque_ripple", 0, values={"n": n}) for n in (9.04, 18.0))
    moved = Term("torque_ripple", 0, values={"n": 9.06})
    assert moved.identity != terms[0].identity
    assert number_of(moved, terms) == 0
    assert [t.values["n"] for t in without(moved, terms)] == [18.0]
