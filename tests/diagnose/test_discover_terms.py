"""Terms of a sum: searched anew beside the others, and left out where the refitted model does not need them."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from planted import declared_fit, log_with

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.discovery import joint_search, proof
from jaxswarm.diagnose.discovery.candidates import _exchanged
from jaxswarm.diagnose.discovery.front import point, region_folds
from jaxswarm.diagnose.discovery.joint_search import NoFormula
from jaxswarm.diagnose.discovery.open_joints import Open
from jaxswarm.diagnose.discovery.pieces import Piece, Range, numbered, scale
from jaxswarm.diagnose.discovery.problem import joint_problem
from jaxswarm.diagnose.discovery.sums import Sum, without_idle, without_term
from jaxswarm.diagnose.folds.other_motion import regions

BRAKE = Piece(("q", "sin", "dq", "*"))
STAND_IN = Piece(("q", "dq", "*"))
CUBE = Piece(("dq", "cube"))
PIECES = (STAND_IN, BRAKE, CUBE, Piece(("q", "square")))


@cache
def fit():
    return declared_fit(log_with())


@cache
def lacking():
    """Joint 2, where two terms are all that the model lacks, and the regions of the log."""
    found, crossfit = fit()
    plain = joint_problem(Linearization(found, crossfit), 1, None)
    q, dq = plain.data["q"], plain.data["dq"]
    torque = plain.lin.on_joint((4.0 * np.sin(q) * dq + dq**3)[:, None], 1)
    whole = replace(crossfit.whole, residual=crossfit.whole.free_part(torque)[:, :, 0])
    lin = Linearization(found, replace(crossfit, whole=whole))
    return joint_problem(lin, 1, None), region_folds(whole, regions(found))


def test_a_factor_that_never_changes_is_left_out():
    """A sign of a load that lies far on one side; of one that goes through zero it stays."""
    found, crossfit = fit()
    plain = joint_problem(Linearization(found, crossfit), 1, None)
    drag = ("dq", "square")
    signed = Piece((*drag, "load", "s", "/", "tanh", "*"), (scale(Range(-1.0, 1.0, 1.0), {}),))
    for load, program in ((plain.data["load"] - 1e4, drag), (plain.data["load"], signed.program)):
        problem = replace(plain, data={**plain.data, "load": load})
        told = without_idle(problem, Sum((signed, CUBE), {"s": 0.5}))
        assert told.programs == (program, CUBE.program)
        assert set(told.values) == {p.name for p in told.constants}


def test_a_term_is_left_out_with_its_own_constants():
    bump = Piece(("dq", "s", "/", "tanh"), (scale(Range(-1.0, 1.0, 1.0), {}),))
    three = Sum(numbered((bump, CUBE, bump)), {"s1": 0.3, "s2": 0.7})
    assert [p.name for p in three.constants] == ["s1", "s2"]
    last = without_term(three, 0)
    assert len(last.pieces) == 2 and list(last.values.values()) == [0.7]
    assert [p.name for p in last.constants] == list(last.values)
    assert without_term(three, 1).values == three.values


def test_a_term_that_stood_in_for_another_is_exchanged_beside_the_next():
    problem, folds = lacking()
    bent = point(problem, Sum((STAND_IN, CUBE), {}), folds)
    assert bent.error > 1e-4
    found, tried = _exchanged(problem, PIECES, bent, folds, 0)
    best = min(found, key=lambda one: one.error)
    assert set(best.formula.programs) == {BRAKE.program, CUBE.program}
    assert best.error < 1e-6 and tried >= 2 * len(PIECES)


def test_a_single_term_is_exchanged_for_nothing():
    problem, folds = lacking()
    assert _exchanged(problem, PIECES, point(problem, Sum((CUBE,), {}), folds), folds, 0) == ([], 0)


@pytest.mark.parametrize(("needed", "left"), [(True, 2), (False, 1)])
def test_a_term_stays_only_where_the_refitted_model_needs_it(monkeypatch, needed, left):
    problem, folds = lacking()
    proved = []

    def prove(diagnosis, open_, problem, one, tried, other):
        proved.append(one)
        return (None, None, one)

    monkeypatch.setattr(proof, "prove", prove)
    monkeypatch.setattr(proof, "regions", lambda found: regions(fit()[0]))
    monkeypatch.setattr(proof, "clearly_better", lambda *args: needed)
    two = point(problem, Sum((BRAKE, CUBE), {}), folds)
    diagnosis = type("Diagnosis", (), {"final": None})()
    rest = (problem, two, 9, (), (None, None, two))
    one, outcome = proof.needed(diagnosis, Open(1, (), 0.5), *rest)
    assert len(one.formula.pieces) == left and outcome[2] is one
    assert len(proved) == (2 if needed else 1)


def found_formula(terms):
    formula = SimpleNamespace(pieces=(None,) * terms)
    return SimpleNamespace(after=None, tried=5, chosen=SimpleNamespace(formula=formula))


@pytest.mark.parametrize(
    ("depends_on", "found_alone", "asked"),
    [
        ((), False, [None, 0]),
        ((), True, [None]),
        (("q_joint1",), False, [0]),
        (("q_joint2",), False, [None, 0]),
        (("q_joint2",), True, [None]),
    ],
)
def test_neighbors_are_asked_where_what_was_named_leads_to_nothing(
    monkeypatch, depends_on, found_alone, asked
):
    found = fit()[0]
    partners = []

    def search(diagnosis, left, variables, *rest):
        partners.extend(partner for partner, _ in variables)
        alone = variables[0][0] is None and found_alone
        return hit if alone else NoFormula(1, 5, None, "nothing")

    hit = found_formula(1)
    monkeypatch.setattr(joint_search, "Discovery", SimpleNamespace)
    monkeypatch.setattr(joint_search, "_search", search)
    monkeypatch.setattr(joint_search, "remainders", lambda fit: [SimpleNamespace(near=True)] * 3)
    diagnosis = SimpleNamespace(final=found)
    outcome = joint_search.search_joint(diagnosis, Open(1, depends_on, 0.5), (), 0)
    assert partners == asked
    assert (outcome is hit) == found_alone


@pytest.mark.parametrize("terms", [2, 3])
@pytest.mark.parametrize(("bits", "with_partner"), [(90.0, True), (130.0, False)])
def test_terms_of_one_joint_are_asked_as_fewer_of_two_joints(
    monkeypatch, bits, with_partner, terms
):
    """dq^2 abs(load) cos(q_other) was told as two terms of one joint, a sixth above the noise.

    Of exp(-(dq/s)^2) abs(load0 q_other) beside a second law three terms of one joint left no more than noise,
    and 50 times the true law's error on unseen motion.
    """
    alone, both = found_formula(terms), found_formula(terms - 1)
    asked = []

    def search(diagnosis, left, variables, label, other, seed, tried=0, terms=3):
        asked.append((variables[0][0], terms))
        return alone if variables[0][0] is None else both

    monkeypatch.setattr(joint_search, "Discovery", SimpleNamespace)
    monkeypatch.setattr(joint_search, "_search", search)
    monkeypatch.setattr(joint_search, "clearly_better", lambda *args: False)
    monkeypatch.setattr(
        joint_search,
        "descriptions",
        lambda fits: [bits if p is both.chosen else 120.0 for p, _ in fits],
    )
    monkeypatch.setattr(joint_search, "remainders", lambda fit: [SimpleNamespace(near=True)] * 3)
    outcome = joint_search.search_joint(SimpleNamespace(final=fit()[0]), Open(1, (), 0.5), (), 0)
    assert asked == [(None, 3), (0, terms - 1)]
    assert outcome is (both if with_partner else alone)
