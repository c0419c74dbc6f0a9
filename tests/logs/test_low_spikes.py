"""Spikes under noise: told where nothing else is nearly as far off."""

import numpy as np
import pytest

from jaxswarm.logs.spikes import find_spikes

ROWS = [300, 900, 1700]


@pytest.fixture
def noisy():
    """A torque of 5 N m under noise of a twentieth of that."""
    rng = np.random.default_rng(3)
    return 2.5 * np.sin(np.arange(3000) * 0.01) + 0.25 * rng.normal(size=3000)


def test_spikes_as_high_as_the_torque_stand_out_of_its_noise(noisy):
    noisy[ROWS] += [6.0, -6.0, 6.0]
    assert np.flatnonzero(find_spikes(noisy)).tolist() == ROWS


def test_one_that_others_come_near_is_none(noisy):
    noisy[ROWS] += [6.0, 2.5, -2.5]
    assert not find_spikes(noisy).any()


def test_a_torque_that_is_mostly_noise_has_spikes_of_its_own_range():
    """No tail of the noise could hold them; where there is one, they would be a part of it."""
    rng = np.random.default_rng(5)
    torque = 0.08 * rng.normal(size=1500)
    torque[515] -= 1.1
    assert np.flatnonzero(find_spikes(torque)).tolist() == [515]
    torque[[200, 800]] += [0.6, 0.6]
    assert not find_spikes(torque).any()


def test_noise_alone_has_none(noisy):
    assert not find_spikes(noisy).any()
