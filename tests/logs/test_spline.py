"""Splines against SciPy's, and what is not loaded for them."""

import subprocess
import sys

import numpy as np
import pytest
from scipy import interpolate

from jaxswarm.logs.spline import spline_at

RNG = np.random.default_rng(0)


@pytest.mark.parametrize("degree", [3, 5])
@pytest.mark.parametrize("samples", [6, 7, 11, 40_000])
@pytest.mark.parametrize("even", [True, False])
def test_it_is_the_spline_of_scipy(degree, samples, even):
    t = np.arange(samples) / 250.0 if even else np.cumsum(RNG.uniform(0.5, 1.5, samples))
    x = np.cumsum(RNG.normal(size=(samples, 2)), axis=0)
    spline = interpolate.make_interp_spline(t, x, k=degree)
    for where in (t, t - 0.3 * (t[1] - t[0]), np.linspace(t[0], t[-1], 5)):
        found = spline_at(t, x, where, range(degree), degree)
        for order, values in enumerate(found):
            expected = spline.derivative(order)(where) if order else spline(where)
            np.testing.assert_allclose(
                values, expected, rtol=0, atol=1e-12 * np.abs(expected).max()
            )


def test_its_shape_is_that_of_the_samples():
    t = np.arange(9.0)
    [value] = spline_at(t, np.ones((9, 3, 2)), t[:4])
    assert value.shape == (4, 3, 2)
    np.testing.assert_allclose(value, 1.0)
    assert spline_at(t, t, t)[0].shape == (9,)


def test_too_few_samples_are_refused():
    with pytest.raises(ValueError, match="degree 5 takes more than 5 samples"):
        spline_at(np.arange(5.0), np.ones(5), np.arange(5.0), (0,), 5)


def test_a_prediction_loads_no_splines_and_no_optimizers(tmp_path):
    """They take a sixth of the time of a short command."""
    code = """
import sys
import numpy as np
import jaxswarm
t = np.arange(0.0, 8.0, 0.01)
q = 0.2 * np.sin(2.5 * t) + 0.05 * np.sin(7.0 * t)
dq = np.gradient(q, t)
tau = 20.0 * np.gradient(dq, t) + 30.0 * dq + 5.0 * np.tanh(dq / 0.01)
tau += 0.1 * np.random.default_rng(0).normal(size=t.size)
log = jaxswarm.log_from_arrays(t, q, tau, joints=("slide",))
found = jaxswarm.identify(log, "emps", "viscous_friction,coulomb_friction")
jaxswarm.predict(found.model, log)
print([name for name in ("scipy.interpolate", "scipy.optimize") if name in sys.modules])"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["[]"]
