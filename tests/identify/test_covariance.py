"""How certain a fit says it is, against how far it is off: linear problems whose errors are drawn."""

import numpy as np
import pytest

from jaxswarm.identify.estimation.covariance import larger
from jaxswarm.identify.estimation.least_squares import fit
from jaxswarm.identify.forward.regression import Regression

LENGTH, PERIOD, COLUMNS, TRIALS = 4000, 400, 6, 60
PHASE = 2.0 * np.pi * np.arange(LENGTH) / PERIOD


def harmonics(rng, count: int, orders: int) -> np.ndarray:
    """Sums of the first harmonics of a motion with random amplitudes and phases, (T, count)."""
    waves = np.concatenate([f(np.outer(PHASE, 1 + np.arange(orders))) for f in (np.sin, np.cos)], 1)
    return waves @ rng.normal(size=(2 * orders, count)) / np.sqrt(2 * orders)


def misses(repeated: float) -> np.ndarray:
    """Errors of the parameters over their standard errors, with so much of a misfit that repeats."""
    found = []
    for seed in range(TRIALS):
        rng = np.random.default_rng(seed)
        columns = harmonics(rng, COLUMNS, 12)
        torque = rng.normal(size=(LENGTH, 1)) + repeated * harmonics(rng, 1, 12)
        rows = np.arange(LENGTH)
        problem = Regression(
            tuple("abcdef"), columns[:, None, :], torque, np.ones((LENGTH, 1), bool),
            rows * 0.01, np.zeros(LENGTH, int), (0.01,),
        )  # fmt: skip
        solution = fit(problem)
        found.append(solution.values / solution.std_error)
    return np.array(found)


def test_noise_is_told_at_its_size():
    covered = (np.abs(misses(0.0)) < 1.96).mean()
    # 360 parameters, standard error of the share 1.2 %; leave-one-out errors are on the large side
    assert 0.93 < covered < 0.99


@pytest.mark.parametrize("repeated", [0.1, 0.3, 1.0])
def test_a_misfit_that_repeats_does_not_average_out(repeated):
    """It is as large after ten periods as after one, and no more certain."""
    assert (np.abs(misses(repeated)) < 1.96).mean() > 0.9


def test_larger_is_at_least_either():
    rng = np.random.default_rng(0)
    a, b = (x @ x.T for x in rng.normal(size=(2, 5, 8)))
    for smaller in (a, b):
        assert np.linalg.eigvalsh(larger(a, b) - smaller).min() > -1e-9
    np.testing.assert_allclose(larger(a, 0.1 * a), a, atol=1e-9)
    nothing = np.zeros((5, 5))
    np.testing.assert_allclose(larger(nothing, b), b, atol=1e-6)
