"""Steps of free parameters: the least cost within bounds, and nothing promised that is not there."""

import numpy as np
import pytest
import scipy
from hypothesis import given
from hypothesis import strategies as st

from jaxswarm.identify.estimation.factors import triangular_factor
from jaxswarm.identify.estimation.newton_step import step_anywhere, step_within


def drawn(seed: int, columns: int, tangents: int):
    """Columns (T, p), tangents (T, m) that are much alike, and what is left of a fit to the columns, (T,)."""
    rng = np.random.default_rng(seed)
    held = rng.normal(size=(60, columns))
    slopes = rng.normal(size=(60, 1)) + 0.3 * rng.normal(size=(60, tangents))
    slopes *= 10.0 ** rng.uniform(-2, 2, tangents)
    left = rng.normal(size=60) + slopes @ rng.normal(size=tangents)
    left -= held @ np.linalg.lstsq(held, left, rcond=None)[0]
    return held, slopes, left


@given(st.integers(0, 10_000), st.integers(1, 5), st.integers(1, 5))
def test_a_step_is_the_best_within_its_bounds(seed, columns, tangents):
    held, slopes, left = drawn(seed, columns, tangents)
    position = np.random.default_rng(seed).choice([0.0, 0.05, 0.5, 1.0], tangents)
    triangle = triangular_factor(np.column_stack([held, slopes, left]))
    step, promised = step_within(triangle, position)
    assert (position + step >= 0.0).all()
    assert (position + step <= 1.0).all()
    q, _ = np.linalg.qr(held)
    free = slopes - q @ (q.T @ slopes)
    bounds = np.maximum(-0.2, -position), np.minimum(0.2, 1.0 - position)
    best = scipy.optimize.lsq_linear(free, left, bounds, method="bvls", tol=1e-14).cost
    after = np.square(left - free @ step).sum()
    assert after <= 2.0 * best * (1 + 1e-6) + 1e-9
    assert promised == pytest.approx(left @ left - after, rel=1e-6, abs=1e-9 * (left @ left))
    assert promised >= -1e-9 * (left @ left)


@pytest.mark.parametrize(("position", "least", "most"), [(1.3, -0.5, -0.3), (-0.05, 0.05, 0.25)])
def test_a_position_beyond_the_range_comes_back(position, least, most):
    held, slopes, left = drawn(1, 2, 2)
    triangle = triangular_factor(np.column_stack([held, slopes, left]))
    step, _ = step_within(triangle, np.array([position, 0.5]))
    assert least <= step[0] <= most


def test_a_tangent_that_the_columns_hold_is_not_followed():
    held, _, left = drawn(0, 3, 1)
    triangle = triangular_factor(np.column_stack([held, held @ [1.0, 2.0, -1.0], left]))
    step, promised = step_within(triangle, np.array([0.5]))
    assert abs(step[0]) < 1e-3
    assert promised < 1e-9
    assert abs(step_anywhere(triangle, 1)[0]) <= 0.2
