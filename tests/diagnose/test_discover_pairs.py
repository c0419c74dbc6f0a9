"""Two laws that hide each other are found together, though neither is among the best by itself."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from planted import declared_fit, log_with

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.discovery.candidates import candidates
from jaxswarm.diagnose.discovery.front import region_folds
from jaxswarm.diagnose.discovery.grammar import programs, skeleton
from jaxswarm.diagnose.discovery.on_host import columns_at, shares_at
from jaxswarm.diagnose.discovery.pairs import _span, best_partners, freed, pairs
from jaxswarm.diagnose.discovery.pieces import Piece
from jaxswarm.diagnose.discovery.problem import joint_problem
from jaxswarm.diagnose.discovery.screening import surveyed
from jaxswarm.diagnose.folds.other_motion import regions

CAM = ("q", "sin", "dq", "abs", "*")
SHOE = ("q", "cube", "dq", "abs", "*", "static_load", "square", "*")
# Every so many programs are enough to hide them among.
_EVERY = 10


@cache
def lacking():
    """Joint 1, where two laws that nearly cancel are all that the model lacks; regions and programs."""
    found, crossfit = declared_fit(log_with())
    plain = joint_problem(Linearization(found, crossfit), 0, None)
    x, fold = plain.data, crossfit.whole
    cam = np.sin(x["q"]) * np.abs(x["dq"])
    shoe = x["q"] ** 3 * np.abs(x["dq"]) * x["static_load"] ** 2
    free = [fold.free_part(plain.lin.on_joint(c[:, None], 0))[:, :, 0] for c in (cam, shoe)]
    one, two = (part / np.linalg.norm(part) for part in free)
    whole = replace(fold, residual=100.0 * (one - two))
    problem = joint_problem(Linearization(found, replace(crossfit, whole=whole)), 0, None)
    pieces = programs(problem.data, problem.units, problem.angles)
    true = [pieces[place(pieces, one)] for one in (CAM, SHOE)]
    return problem, region_folds(whole, regions(found)), [*pieces[::_EVERY], *true]


def place(pieces, program):
    return next(k for k, p in enumerate(pieces) if skeleton(p.program) == skeleton(program))


def test_two_laws_are_found_together_that_are_not_among_the_best_alone():
    problem, folds, pieces = lacking()
    rows = problem.rows_of(problem.lin.crossfit.whole)
    shares = surveyed(problem, rows, pieces)[2]
    rank = [int((shares > shares[place(pieces, p)]).sum()) for p in (CAM, SHOE)]
    assert min(rank) > 20  # of which a term alone is tried
    found, tried = pairs(problem, pieces, folds)
    best = min(found, key=lambda one: one.error)
    told = {skeleton(p) for p in best.formula.programs}
    assert told == {skeleton(CAM), skeleton(SHOE)}
    # Planted by the load as it is; fitted by that of a model that has taken up a part of the two.
    assert best.error < 5e-3
    assert tried == len(pieces) * (len(pieces) - 1) // 2


def test_what_two_columns_take_off_is_that_of_a_fit():
    rng = np.random.default_rng(0)
    columns = rng.normal(size=(7, 50)).astype(np.float32)
    columns[3] = columns[2] + 1e-3 * columns[4]  # alike: no pair
    columns /= np.linalg.norm(columns, axis=1)[:, None]
    residual = rng.normal(size=50).astype(np.float32)

    def left(one, two):
        matrix = columns[[one, two]].T
        return np.linalg.norm(residual - matrix @ np.linalg.lstsq(matrix, residual)[0])

    for one, two in best_partners(columns, columns @ residual):
        assert {one, two} != {2, 3} and one != two
        others = [k for k in range(7) if k != one and {one, k} != {2, 3}]
        assert left(one, two) == pytest.approx(min(left(one, k) for k in others), rel=1e-4)


def test_freed_columns_and_their_products_are_those_over_all_joints():
    problem, _, _ = lacking()
    fold = problem.lin.crossfit.whole
    rows = problem.rows_of(fold)
    pieces = (Piece(("q", "dq", "*")), Piece(("q", "square", "dq", "*")), Piece(("dq",)))
    points = np.full((1, 3), 0.5, np.float32)
    raw = np.concatenate([columns_at(problem.names, rows, p, points) for p in pieces])
    free, along, own = freed(raw, rows, _span(rows))
    assert own.tolist() == [True, True, False]  # viscous friction is declared
    shares = [shares_at(problem.names, rows, p, points)[0] for p in pieces[:2]]
    assert along[:2] ** 2 == pytest.approx(shares, rel=1e-3)
    inner = raw @ np.asarray(rows.basis)
    product = raw @ raw.T - inner @ inner.T
    wanted = product[0, 1] / np.sqrt(product[0, 0] * product[1, 1])
    assert free[0] @ free[1] == pytest.approx(wanted, rel=1e-3)


def test_a_search_ends_with_both():
    problem, _, pieces = lacking()
    label = regions(problem.lin.found)
    _, points, _ = candidates(problem, pieces, label, 0)
    told = {skeleton(p) for p in points[0].formula.programs}
    assert told == {skeleton(CAM), skeleton(SHOE)}
