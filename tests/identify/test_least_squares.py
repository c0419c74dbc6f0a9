"""Weighted least squares against numpy, bounds against a brute-force search, intervals by their coverage."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from small_problems import make_regression, waves

from jaxswarm.identify.estimation.bounded import solve
from jaxswarm.identify.estimation.covariance import correlation_length, moving_sums
from jaxswarm.identify.estimation.factors import (
    compress,
    joint_factors,
    narrow_factor,
    weighted_factor,
)
from jaxswarm.identify.estimation.least_squares import fit, solved
from jaxswarm.identify.estimation.validate import held_out_residual

TRUTH = np.array([1.5, -0.7, 0.3, 2.0])


@pytest.fixture(scope="module")
def columns():
    return waves(np.random.default_rng(0), 400, 2, 4)


def noisy(columns, seed=1, sigma=(0.1, 1.0)):
    rng = np.random.default_rng(seed)
    return columns @ TRUTH + np.array(sigma) * rng.normal(size=columns.shape[:2])


def test_given_weights_give_numpys_solution(columns):
    torque, sigma = noisy(columns), np.array([0.1, 1.0])
    found = fit(make_regression(columns, torque), sigma=sigma)
    rows = (columns / sigma[:, None]).reshape(-1, 4)
    expected, cost, *_ = np.linalg.lstsq(rows, (torque / sigma).ravel(), rcond=None)
    np.testing.assert_allclose(found.values, expected, rtol=1e-10)
    np.testing.assert_allclose(found.cost, cost[0], rtol=1e-9)
    np.testing.assert_allclose(found.residual, torque - columns @ expected, atol=1e-10)


def test_weights_are_found_from_the_residual(columns):
    found = fit(make_regression(columns, noisy(columns)))
    np.testing.assert_allclose(found.sigma, [0.1, 1.0], rtol=0.1)
    assert np.abs(found.values - TRUTH).max() < 0.05
    # Weighted by their own noise the two joints give less error than by rows counted alike.
    plain = fit(make_regression(columns, noisy(columns)), sigma=np.ones(2))
    assert np.linalg.norm(found.std_error) < np.linalg.norm(plain.std_error)


@pytest.mark.parametrize("ratio", [1.0, 1e-3])
def test_weights_do_not_go_by_where_they_began(ratio):
    """Of joints that share parameters a quiet one is found late."""
    rng = np.random.default_rng(3)
    columns = waves(rng, 800, 3, 8)
    noise = np.array([1.0, 0.03, ratio]) * 0.1
    torque = columns @ rng.normal(size=8) * 10.0 + noise * rng.normal(size=(800, 3))
    problem = make_regression(columns, torque)
    one = fit(problem)
    left = np.linalg.norm(torque - columns @ one.theta, axis=0) / np.sqrt(800 - 8 / 3)
    np.testing.assert_allclose(one.sigma, left, rtol=3e-4)
    for begin in (np.ones(3), 1e-3 * np.ones(3), noise[::-1]):
        other = solved(problem, near=begin)
        np.testing.assert_allclose(other.sigma, one.sigma, rtol=3e-4)
        np.testing.assert_allclose(other.values, one.values, atol=3e-4 * one.std_error.min())


def test_the_compressed_cost_is_the_cost(columns):
    torque, sigma = noisy(columns), np.array([0.2, 0.7])
    found = fit(make_regression(columns, torque), sigma=sigma)
    for theta in np.random.default_rng(2).normal(size=(5, 4)):
        direct = (((torque - columns @ theta) / sigma) ** 2).sum()
        compressed = ((found.factor @ theta - found.target) ** 2).sum() + found.cost
        assert compressed == pytest.approx(direct, rel=1e-10)


def test_noise_free_data_give_the_truth_and_no_doubt(columns):
    found = fit(make_regression(columns, columns @ TRUTH))
    np.testing.assert_allclose(found.values, TRUTH, rtol=1e-10)
    assert found.std_error.max() < 1e-8


def test_factors_of_joints_stack_to_the_factor_of_all(columns):
    regression = make_regression(columns, noisy(columns))
    sigma = np.array([0.5, 2.0])
    triangle = weighted_factor(joint_factors(regression), sigma)
    rows = np.concatenate([columns, regression.torque[:, :, None]], axis=2) / sigma[:, None]
    rows = rows.reshape(-1, 5)
    np.testing.assert_allclose(triangle.T @ triangle, rows.T @ rows, rtol=1e-10, atol=1e-8)
    assert compress(columns[:2, 0], regression.torque[:2, 0]).shape == (2, 5)


def test_columns_of_zeros_cost_no_rows_of_a_factor(columns):
    # As of the last joint: nothing of the links before it.
    block = np.concatenate([columns[:, 1], noisy(columns)[:, 1:]], axis=1)
    block[:, :2] = 0.0
    factor = narrow_factor(block)
    assert factor.shape == (3, 5)
    np.testing.assert_allclose(factor.T @ factor, block.T @ block, rtol=1e-10, atol=1e-10)
    # A torque that is zero counts all the same, and so does a joint that feels nothing.
    assert narrow_factor(0.0 * block).shape == (1, 5)
    # Fewer rows than columns are filled up, so that nobody asks how many there are.
    assert weighted_factor([factor, narrow_factor(0.0 * block)], np.ones(2)).shape == (5, 5)


def test_fits_of_joints_that_feel_little_are_numpys(columns):
    sparse = columns.copy()
    sparse[:, 0, 2:] = 0.0
    sparse[:, 1, :2] = 0.0
    torque = sparse @ TRUTH
    torque[:, 0] += 0.1 * np.sin(np.arange(400.0))
    found = fit(make_regression(sparse, torque), sigma=np.ones(2))
    expected = np.linalg.lstsq(sparse.reshape(-1, 4), torque.ravel(), rcond=None)[0]
    np.testing.assert_allclose(found.values, expected, rtol=1e-10)


def test_dependent_columns_merge():
    rng = np.random.default_rng(3)
    columns = waves(rng, 300, 2, 4)
    columns[:, :, 3] = 2.0 * columns[:, :, 0] - columns[:, :, 1]
    found = fit(make_regression(columns, columns @ TRUTH))
    assert found.base.expressions() == ("c0 + 2 c3", "c1 - c3", "c2")
    np.testing.assert_allclose(found.values, [5.5, -2.7, 0.3], atol=1e-9)
    np.testing.assert_allclose(found.theta, [5.5, -2.7, 0.3, 0.0], atol=1e-9)


def brute_force(matrix, target, lower, upper):
    """Best of all ways to fix each component free, at its lower or at its upper bound."""
    best = (np.inf, None)
    for state in itertools.product((0, 1, 2), repeat=len(lower)):
        state = np.array(state)
        theta = np.where(state == 1, lower, upper)
        free = state == 0
        if free.any():
            rest = target - matrix[:, ~free] @ theta[~free]
            theta[free] = np.linalg.lstsq(matrix[:, free], rest, rcond=None)[0]
        if ((theta >= lower - 1e-12) & (theta <= upper + 1e-12)).all():
            best = min(best, (((matrix @ theta - target) ** 2).sum(), tuple(theta)))
    return np.array(best[1])


@pytest.mark.parametrize("seed", range(5))
def test_bounds_hold_and_the_rest_is_optimal(seed):
    rng = np.random.default_rng(seed)
    matrix, target = np.triu(rng.normal(size=(4, 4))) + 2 * np.eye(4), rng.normal(size=4)
    factor = np.column_stack([matrix, target])
    free = np.linalg.solve(matrix, target)
    lower, upper = np.sort(free + rng.normal(size=(2, 4)), axis=0)
    theta, at_bound = solve(factor, lower, upper)
    np.testing.assert_allclose(theta, brute_force(matrix, target, lower, upper), atol=1e-9)
    np.testing.assert_array_equal(at_bound, (theta == lower) | (theta == upper))


def test_a_parameter_at_its_bound_is_marked_and_has_no_variance(columns):
    lower, upper = np.array([-np.inf, 0.0, -np.inf, -np.inf]), np.full(4, np.inf)
    found = fit(make_regression(columns, noisy(columns)), lower, upper)
    assert list(found.at_bound) == [False, True, False, False]
    assert found.values[1] == 0.0
    assert found.std_error[1] == 0.0


def test_bounds_are_dropped_where_others_merge():
    columns = waves(np.random.default_rng(4), 300, 1, 2)
    columns[:, :, 1] = -columns[:, :, 0]
    found = fit(make_regression(columns, -3.0 * columns[:, :, 0]), np.zeros(2), np.full(2, np.inf))
    assert found.values == pytest.approx([-3.0])


def autoregressive(rng, shape, rho):
    noise = rng.normal(size=shape) * np.sqrt(1 - rho**2)
    noise[0] /= np.sqrt(1 - rho**2)
    for k in range(1, shape[0]):
        noise[k] += rho * noise[k - 1]
    return noise


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.9])
def test_correlation_length_of_a_first_order_process(rho):
    noise = autoregressive(np.random.default_rng(5), (20000, 3), rho)
    found = correlation_length(noise, np.zeros(20000, int))
    assert found == pytest.approx((1 + rho) / (1 - rho), rel=0.15, abs=0.05)


def test_correlation_does_not_cross_logs():
    noise = np.repeat(np.random.default_rng(6).normal(size=(500, 1)), 2, axis=0)
    pairs = np.repeat(np.arange(500), 2)
    # The sum of one perfect lag within pairs, none across; counted over all rows.
    assert correlation_length(noise, pairs) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("rho", [0.0, 0.8])
def test_intervals_cover_the_truth(rho):
    rng = np.random.default_rng(7)
    columns, draws = waves(rng, 800, 2, 4), 220
    base = fit(make_regression(columns, columns @ TRUTH)).base
    hits = np.zeros((draws, 4), bool)
    for k in range(draws):
        noise = np.array([0.3, 1.0]) * autoregressive(rng, (800, 2), rho)
        found = fit(make_regression(columns, columns @ TRUTH + noise), base=base)
        hits[k] = np.abs(found.values - TRUTH) <= 1.96 * found.std_error
    assert 0.90 <= hits.mean() <= 0.98
    # White-noise formulas would cover only about half of it where the noise is correlated.
    if rho:
        assert found.effective_samples < 0.3 * hits[0].size * 400


def test_several_logs_are_one_problem(columns):
    torque = noisy(columns)
    whole = fit(make_regression(columns, torque))
    log = (np.arange(400) >= 200).astype(int)
    split = fit(make_regression(columns, torque, log))
    np.testing.assert_allclose(whole.values, split.values, rtol=1e-12)


def test_condition_number_sees_near_dependence(columns):
    close = columns.copy()
    close[:, :, 1] = columns[:, :, 0] + 1e-4 * columns[:, :, 1]
    good = fit(make_regression(columns, noisy(columns))).condition
    bad = fit(make_regression(close, noisy(columns))).condition
    assert good < 10 < 1e3 < bad


def test_a_column_that_only_one_block_excites_is_absent_where_that_block_is_held_out():
    rng = np.random.default_rng(3)
    columns = waves(rng, 400, 2, 3)
    columns[:, :, 2] = 0.0
    columns[180:220, :, 2] = 1.0  # a contact
    torque = columns @ np.array([2.0, -1.0, 5.0]) + 0.01 * rng.normal(size=(400, 2))
    problem = make_regression(columns, torque)
    found = SimpleNamespace(regression=problem, fit=fit(problem))
    residual = held_out_residual(found)
    out = np.zeros(400, bool)
    out[180:220] = True
    np.testing.assert_allclose(residual[out].mean(), 5.0, atol=0.05)
    assert np.abs(residual[~out]).max() < 0.1


def test_held_out_blocks_are_fitted_within_the_bounds_of_the_fit():
    """Torques whose sign is wrong: friction is held at zero, on held-out blocks too."""
    rng = np.random.default_rng(4)
    columns = waves(rng, 400, 1, 2)
    torque = columns @ np.array([1.0, -2.0]) + 0.01 * rng.normal(size=(400, 1))
    problem = make_regression(columns, torque)
    bounded = fit(problem, np.array([-np.inf, 0.0]), np.full(2, np.inf))
    assert bounded.at_bound.tolist() == [False, True]
    residual = held_out_residual(SimpleNamespace(regression=problem, fit=bounded))
    assert residual.std() > 0.95 * bounded.residual.std()


def test_windows_give_the_tapered_sum_over_lags_log_by_log():
    rng = np.random.default_rng(3)
    log = np.repeat([0, 1, 2], [170, 3, 60])
    error = autoregressive(rng, (len(log), 2), 0.7)
    u, limit, size = rng.normal(size=(len(log), 4)) * error[:, :1], 9, 4
    windows = [moving_sums(u[log == k], limit + 1) for k in range(3)]
    found = sum(own.T @ own for own in windows) / (limit + 1)
    expected = np.zeros((size, size))
    for a, b in itertools.product(range(len(log)), repeat=2):
        if log[a] == log[b] and abs(a - b) <= limit:
            expected += (1.0 - abs(a - b) / (limit + 1)) * np.outer(u[a], u[b])
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)
