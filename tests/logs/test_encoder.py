"""Positions between the counts of an encoder."""

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jaxswarm.logs.encoder import between_counts

STEP = 2.0 * np.pi / 2**15
T = np.arange(0.0, 8.0, 0.004)


def counted(x):
    return (np.round(x / STEP) * STEP)[:, None]


def creep(speed):
    return 0.3 * STEP + speed * T


def test_a_creeping_joint_is_known_to_a_fraction_of_a_count():
    true = creep(0.002)
    read = between_counts(T, counted(true))[:, 0]
    inside = slice(200, -200)
    plain = np.abs(counted(true)[:, 0] - true)[inside].max()
    assert plain > 0.45 * STEP
    assert np.abs(read - true)[inside].max() < 0.1 * STEP
    # Its velocity is steady, where the counts make pulses of half a count a sample.
    assert np.abs(np.diff(read)[inside] / 0.004 - 0.002).max() < 0.3 * 0.002


def test_a_joint_that_crosses_counts_with_every_sample_is_left_as_it_is():
    fast = counted(0.5 * np.sin(3.0 * T + 0.2) + 2.0 * T)
    np.testing.assert_array_equal(between_counts(T, fast), fast)


def test_a_joint_that_turns_round_within_a_count_keeps_between_its_boundaries():
    true = 12 * STEP * np.sin(0.7 * T)
    read = between_counts(T, counted(true))[:, 0]
    assert np.abs(read - true).max() <= STEP
    assert np.sqrt(np.mean((read - true) ** 2)) < 0.7 * np.sqrt(
        np.mean((counted(true)[:, 0] - true) ** 2)
    )


@pytest.mark.parametrize("make", [lambda x: x, lambda x: x + 1e-5 * np.sin(91 * T)])
def test_positions_on_no_grid_are_left_as_they_are(make):
    held = np.repeat(make(0.1 * np.sin(T))[::8], 8)[: len(T), None]
    np.testing.assert_array_equal(between_counts(T, held), held)


def test_the_rounding_of_a_number_is_no_step_of_an_encoder():
    """Every number is a whole multiple of 1e-30, of which an integer holds no count."""
    held = np.repeat(0.1 * np.sin(T)[::8], 8)[: len(T), None]
    held[3] += 1e-30
    with warnings.catch_warnings(action="error"):
        np.testing.assert_array_equal(between_counts(T, held), held)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.floats(1e-4, 0.05))
def test_no_position_leaves_its_count_by_more_than_half_of_one(seed, size):
    rng = np.random.default_rng(seed)
    true = np.cumsum(rng.normal(size=len(T))) * size * 1e-3
    raw = counted(true)
    assert np.abs(between_counts(T, raw) - raw).max() <= 0.5 * STEP * (1 + 1e-9)
