"""What is found for many candidates at a time is what is found for each by itself."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.diagnose.candidates import swings
from jaxswarm.diagnose.folds.fold_data import FoldData, explained
from jaxswarm.diagnose.folds.free_parts import free_parts
from jaxswarm.diagnose.folds.joint_rows import joint_rows
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects.term import parse_terms
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import random_links, synthetic_log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import load_robot

RIDGE = 0.03


@pytest.fixture(scope="module")
def crossfit():
    robot = load_robot("rx60")
    robot = robot.replace(parameters=random_links(robot, np.random.default_rng(0)))
    terms = parse_terms("viscous_friction,coulomb_friction", robot.joints)
    true = tuple(replace(t, values={p.name: 2.0 for p in t.law.parameters}) for t in terms)
    seen = prepare(synthetic_log(robot, true, 0, duration=6.0))
    return cross_fit(estimate(robot, terms, [seen], bounded=False))


def some_folds(rng, rows=240, size=7):
    odd = np.arange(rows) // 40 % 2
    train = np.stack([np.ones(rows), odd, 1 - odd]).astype(float)
    basis = [np.linalg.qr(rng.normal(size=(rows, size)) * t[:, None])[0] for t in train]
    return FoldData(np.stack(basis), rng.normal(size=(3, rows)) * train, train, 0 * train)


def least_squares_gain(columns, fold, positive):
    """Fall of the squared residual by columns freed of the model, by a solver."""
    own = fold.train > 0
    basis, right = fold.basis[own], columns[own].T @ fold.residual[own]
    if positive and right[0] <= 0:
        return 0.0
    free = columns[own] - basis @ (basis.T @ columns[own])
    return right @ np.linalg.solve(free.T @ free, right)


@pytest.mark.parametrize("width", [1, 2, 3])
@pytest.mark.parametrize("positive", [False, True])
def test_columns_of_many_points_explain_what_each_explains(width, positive):
    rng = np.random.default_rng(width)
    folds = some_folds(rng)
    columns = rng.normal(size=(5, 240, width))
    found = jax.jit(explained)(jnp.asarray(columns), folds, positive)
    for s in range(3):
        fold = jax.tree.map(lambda x, s=s: x[s], folds)
        for m, own in enumerate(columns):
            exact = least_squares_gain(own, fold, positive)
            assert float(found[s, m]) == pytest.approx(exact, rel=1e-6, abs=1e-12)


def test_a_column_of_zeros_says_nothing_and_hides_nothing():
    """The compiler multiplies divisors: of a column without size they must not become zero."""
    rng = np.random.default_rng(3)
    folds = some_folds(rng)
    columns = rng.normal(size=(4, 240, 2))
    columns[:, :, 1] = 0.0
    both = jax.jit(explained)(jnp.asarray(columns), folds, False)
    one = jax.jit(explained)(jnp.asarray(columns[:, :, :1]), folds, False)
    np.testing.assert_allclose(both, one, rtol=1e-12)


def test_free_parts_of_many_are_those_of_each(crossfit, monkeypatch):
    rng = np.random.default_rng(4)
    shape = crossfit.weight.shape
    several = [
        tuple(rng.normal(size=(*shape, k)) for _ in crossfit.folds) for k in (1, 3, 1, 2, 1, 1)
    ]
    monkeypatch.setitem(free_parts.__globals__, "_AT_ONCE", 4 * np.prod(shape))
    together = list(free_parts(several, crossfit))
    assert len(together) == len(several)
    for columns, parts in zip(several, together, strict=True):
        for fold, own, part in zip(crossfit.folds, columns, parts, strict=True):
            np.testing.assert_allclose(part, fold.free_part(own), atol=1e-10)


def test_what_the_model_has_is_free_by_nothing_not_by_rounding(crossfit):
    known = crossfit.whole.project[:, :, :2] @ np.array([[1.0], [-3.0]])
    other = np.random.default_rng(6).normal(size=known.shape)
    both = np.concatenate([known, known + 1e-4 * other], axis=2)
    for part in next(free_parts([(both,) * 3], crossfit)):
        assert not part[:, :, 0].any()
        assert part[:, :, 1].any()


def test_no_candidates_have_no_free_parts(crossfit):
    assert list(free_parts([], crossfit)) == []


def test_a_model_that_is_held_leaves_columns_as_they_are(crossfit):
    nothing = np.zeros((*crossfit.weight.shape, 0))
    held = [replace(f, project=nothing, basis=nothing) for f in crossfit.folds]
    free = replace(crossfit, whole=held[0], halves=(held[1], held[2]))
    columns = np.random.default_rng(5).normal(size=(*crossfit.weight.shape, 2))
    for part in next(free_parts([(columns,) * 3], free)):
        np.testing.assert_array_equal(part, columns)


@pytest.mark.parametrize("joint", [0, 2])
def test_rows_of_a_joint_say_what_freed_columns_say(crossfit, joint):
    """Squares of freed columns without freeing them, and what their ridge fit says of other rows."""
    rng = np.random.default_rng(6)
    columns = rng.normal(size=(len(crossfit.weight), 9))
    for fold in crossfit.halves:
        free = fold.free_rows(columns, joint)
        inside, outside = free[fold.train], free[~fold.train]
        square = inside.T @ inside
        held = RIDGE * np.trace(square) / len(square) * np.eye(len(square))
        a = np.linalg.solve(square + held, inside.T @ fold.residual[fold.train, joint])
        rows = joint_rows(fold, joint)
        (said,) = rows.predicted(columns[fold.train], columns[~fold.train], (0.03,))
        np.testing.assert_allclose(said, outside @ a, rtol=1e-8, atol=1e-10)
        np.testing.assert_array_equal(rows.unseen, fold.residual[~fold.train, joint])


def test_options_that_feel_alike_lag_as_if_each_felt_for_itself():
    """A signal for all options and the same signal written out for each are one to the last bit."""
    rng = np.random.default_rng(7)
    t = np.arange(1024) / 250.0
    felt = [np.sin(3 * t), 0.3 + 0 * t, 0.1 + 0 * t, 1.0 + 0.2 * np.cos(t)]
    gear = [np.geomspace(100.0, 1e4, 5), np.geomspace(1.0, 5.0, 5), rng.uniform(0, 1e-3, 5)]
    gear = [*gear, np.zeros(5)]
    alike = swings._lags(*(x[:, None] for x in felt), *gear, 0.004, 0, 2)
    apart = swings._lags(*(np.repeat(x[:, None], 5, axis=1) for x in felt), *gear, 0.004, 0, 2)
    for one, other in zip(alike, apart, strict=True):
        assert one.shape == (1024, 5)
        np.testing.assert_array_equal(one, other)
