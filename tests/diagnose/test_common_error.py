"""What the fit to a half is off by is common to all blocks of the other one, and no evidence."""

from types import SimpleNamespace

import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.decision.common_error import p_value_beside_fit, shared_error
from jaxswarm.diagnose.decision.score import score
from jaxswarm.diagnose.folds.partial_out import CrossFit, Fold
from jaxswarm.effects.term import Term

T, BLOCKS = 400, 20
TIME = np.linspace(-1.0, 1.0, T)
LAW = Term("joint_spring", 0)


def fold(train, torque):
    """A line fitted to some rows."""
    columns = np.stack([np.ones(T), TIME], axis=1)
    q, r = np.linalg.qr(columns[train])
    project = (columns @ np.linalg.inv(r))[:, None]
    basis = np.where(train[:, None, None], project, 0.0)
    told = np.einsum("tjb,tj->b", basis, torque)
    return Fold(train, project, basis, torque - project @ told, np.linalg.inv(r), told)


def crossfit(torque):
    """Halves that are apart: the first and the second half of the time."""
    early = TIME < 0
    folds = [fold(rows, torque) for rows in (np.ones(T, bool), early, ~early)]
    weight, log = np.ones((T, 1)), np.zeros(T, int)
    block = np.arange(T) * BLOCKS // T
    one = np.ones(1)
    return CrossFit(weight, log, block, folds[0], (folds[1], folds[2]), T, one, one, one, weight)


def asked(torque):
    """The p-value of a cubic part, as it is and with the error of the fits."""
    folds = crossfit(torque)
    columns = (TIME**3)[:, None, None]
    found = score(Candidate(LAW, (columns,) * 3, 1), folds)
    return found, folds


def test_noise_is_told_as_a_law_no_more_often_than_by_chance():
    rng = np.random.default_rng(0)
    raw, told = [], []
    for _ in range(300):
        found, folds = asked(rng.normal(size=(T, 1)))
        raw.append(found.p_value < 0.001)
        told.append(p_value_beside_fit(found, folds) < 0.001)
    assert np.mean(raw) > 0.1  # a hundred times the level
    assert np.mean(told) < 0.01


def test_what_is_there_is_told_as_surely_where_it_is_large():
    found, folds = asked(20.0 * (TIME**3)[:, None] + np.random.default_rng(1).normal(size=(T, 1)))
    assert found.p_value < p_value_beside_fit(found, folds) < 1e-3


def test_the_error_of_the_fit_is_as_large_as_noise_makes_it():
    """The slope's variance over many draws of noise is what both parts say."""
    rng = np.random.default_rng(2)
    found, folds = asked((TIME**3)[:, None])
    free = folds.halves[0].free_part((TIME**3)[:, None, None])[:, :, 0]
    unseen = ~folds.halves[0].train
    p = free[unseen]
    slopes = []
    for _ in range(2000):
        left = fold(folds.halves[0].train, rng.normal(size=(T, 1))).residual[unseen]
        slopes.append(float((p * left).sum() / (p**2).sum()))
    reached = np.einsum("tjb,tj->b", folds.halves[0].project[unseen], p)
    shared = float(reached @ reached / (p**2).sum())
    assert np.isclose(np.var(slopes) * (p**2).sum(), 1.0 + shared, rtol=0.1)
    assert shared_error(found, folds) > 1.0
    event = SimpleNamespace(law=SimpleNamespace(recurring=True))
    few = SimpleNamespace(candidate=SimpleNamespace(term=event), p_value=0.2)
    assert p_value_beside_fit(few, folds) == 0.2
