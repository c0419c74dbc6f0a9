"""An arm of six joints with links drawn at random, and a clean log of it, that many checks are tried on."""

import numpy as np
import pytest

from jaxswarm.identify.synthetic import Noise, random_links, synthetic_log
from jaxswarm.robot.load import load_robot


@pytest.fixture(scope="module")
def arm():
    bare = load_robot("ur10e")
    return bare.replace(parameters=random_links(bare, np.random.default_rng(0), mass=20.0))


@pytest.fixture(scope="module")
def log(arm):
    return synthetic_log(arm, (), 3, noise=Noise(2e-5, 0.05), duration=20.0, rate=125.0)
