"""The filter that runs forth and back against SciPy's."""

import numpy as np
import pytest
from scipy import signal

from jaxswarm.logs.butterworth import butterworth


@pytest.mark.parametrize("high", [False, True])
@pytest.mark.parametrize(("order", "cutoff"), [(4, 30.0), (6, 3.0), (2, 110.0)])
def test_it_is_the_filter_of_scipy(order, cutoff, high):
    x = np.cumsum(np.random.default_rng(0).normal(size=(3000, 2)), axis=0) + 5.0
    sections = signal.butter(order, cutoff, "high" if high else "low", fs=250.0, output="sos")
    expected = signal.sosfiltfilt(sections, x, axis=0)
    found = butterworth(x, 250.0, cutoff, order, high=high)
    np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(x).max())


def test_one_column_and_a_few_samples():
    x = np.random.default_rng(1).normal(size=12)
    found = butterworth(x, 100.0, 20.0, 4)
    assert found.shape == (12,) and np.isfinite(found).all()
    np.testing.assert_allclose(butterworth(np.full(50, 3.0), 100.0, 20.0, 4), 3.0, atol=1e-12)
