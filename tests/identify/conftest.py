"""A clean log of the arm of six joints that many checks are tried on."""

import pytest

from jaxswarm.identify.synthetic import Noise, synthetic_log


@pytest.fixture(scope="module")
def log(arm):
    return synthetic_log(arm, (), 3, noise=Noise(2e-5, 0.05), duration=20.0, rate=125.0)
