"""Logs at multiples of the detection limit show their effect: friction that grows with rest needs rests."""

import numpy as np
import pytest

from benchmarks.diagnosis_cases import VISIBLE, Case, make_case
from benchmarks.diagnosis_rests import halting_motion
from jaxswarm.diagnose.candidates.eligible import longest_rest
from jaxswarm.effects.base import REGISTRY
from jaxswarm.logs.motion import prepare


def test_a_motion_with_rests_has_the_velocity_of_its_positions():
    t, q, dq, ddq = halting_motion(2, np.random.default_rng(4))
    np.testing.assert_allclose(np.gradient(q, t, axis=0)[1:-1], dq[1:-1], atol=2e-3)
    np.testing.assert_allclose(np.gradient(dq, t, axis=0)[1:-1], ddq[1:-1], atol=0.3)
    still = np.abs(dq).max(axis=1) < 1e-9
    assert 0.2 < still.mean() < 0.8
    assert not still[0] and not still[-1]


def test_the_log_of_friction_that_grows_with_rest_rests():
    case = Case("dwell_friction", 0, 0, 1.0, 7200, 4.0)
    *_, hidden, log, ratio = make_case(case)
    assert [t.effect for t in hidden] == [case.effect]
    assert ratio.max() == pytest.approx(4.0 * VISIBLE, rel=0.2)
    assert longest_rest((prepare(log),), 0) > REGISTRY[case.effect].rests


def test_other_logs_move_as_before():
    *_, log, _ = make_case(Case("friction_change", 0, 0, 1.0, 7100, 4.0))
    assert log.t[-1] == pytest.approx(20.0, abs=0.01)
