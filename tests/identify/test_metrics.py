"""Errors of a torque prediction."""

import tracemalloc

import numpy as np
import pytest

from jaxswarm.identify.forward.metrics import torque_errors


def test_what_is_not_scored_counts_for_nothing():
    rng = np.random.default_rng(0)
    measured, predicted = rng.normal(size=(2, 90, 2))
    moving, scored = rng.random((2, 90, 2)) > 0.4
    told = torque_errors(measured, predicted, moving, scored)
    for j in range(2):
        rows = scored[:, j]
        alone = torque_errors(*(x[rows][:, [j]] for x in (measured, predicted, moving)))
        for name in ("rms", "relative", "rae", "rms_moving", "rms_standing"):
            assert told[name][j] == pytest.approx(alone[name][0], rel=1e-12), name
    error = np.where(scored, measured - predicted, 0.0)
    whole = np.linalg.norm(error) / np.linalg.norm(np.where(scored, measured, 0.0))
    assert told["relative_global"] == pytest.approx(whole, rel=1e-12)


def test_errors_of_a_long_log_are_found_a_joint_at_a_time():
    rng = np.random.default_rng(0)
    measured, predicted = rng.normal(size=(2, 100_000, 7))
    moving = measured > 0.0
    tracemalloc.start()
    try:
        torque_errors(measured, predicted, moving)
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert most < 0.7 * measured.nbytes
