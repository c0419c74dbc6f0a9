"""What a fit to the other rows does not know of a row says nothing against a candidate."""

from importlib import import_module

import numpy as np
import pytest
from planted import BAND, DECLARED, NOISE, RATE, blank, small_arm

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.common_error import p_value_beside_fit
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.folds.foretold import foretold
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.identify.synthetic import synthetic_log
from jaxswarm.logs.motion import prepare

scoring = import_module("jaxswarm.diagnose.decision.score")

SECONDS, PICKED_UP = 32.0, 13.0
# The one move of joint 1; all others are of joint 2.
OF_JOINT_1 = 13
BODY = {"m": 1.5, "mcx": 0.1, "mcy": 0.02, "mcz": 0.05, "Ixx": 0.01, "Iyy": 0.02, "Izz": 0.02}


def one_at_a_time():
    """t (T,), q, dq, ddq (T, 2) of moves of one joint at a time, with rests between."""
    t, rng = np.arange(0.0, SECONDS, 1.0 / RATE), np.random.default_rng(0)
    q, dq, ddq = np.zeros((3, len(t), 2))
    now, place, number = 0.5, np.zeros(2), 0
    while now < SECONDS - 1.0:
        j, far = int(number != OF_JOINT_1), rng.uniform(-1.0, 1.0)
        size = far - place[j]
        length = max(0.8, 1.4 * abs(size)) if j else 0.6
        u = np.clip((t - now) / length, 0.0, 1.0)
        q[:, j] += size * u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
        dq[:, j] += size * 30.0 * u * u * (1.0 - u) ** 2 / length
        ddq[:, j] += size * 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / length**2
        place[j], now, number = far, now + length + 0.3, number + 1
    return t, q, dq, ddq


@pytest.fixture(scope="module")
def jogged():
    """The fit of a log in which a load is picked up while the joints move one at a time."""
    values = {"Ixy": 0.0, "Ixz": 0.0, "Iyz": 0.0, "start": PICKED_UP, "end": 1e5, "log": 0.0}
    load = Term("payload_change", values=BODY | values)
    moved = one_at_a_time()
    log = synthetic_log(small_arm(), (*DECLARED, load), 1, noise=NOISE, rate=RATE, moved=moved)
    return with_motion_noise(estimate(small_arm(), blank(), [prepare(log, BAND)], bounded=False))


def scored(found):
    (one,) = score_terms(Linearization(found, cross_fit(found)), [Term("payload_change")], 0)
    return one


def test_the_only_move_of_a_joint_says_nothing_against_a_load(jogged):
    one = scored(jogged)
    assert abs(one.candidate.term.values["start"] - PICKED_UP) < 0.5
    assert one.p_value < 1e-6 and one.share > 0.99 and one.gain > 0.0
    assert p_value_beside_fit(one, cross_fit(jogged)) < 1e-6


def test_with_every_row_alike_it_might_have_been_chance(jogged, monkeypatch):
    """The block of that move is told by rows in which the joint does not move."""
    monkeypatch.setattr(scoring, "foretold", lambda project: np.ones(project.shape[:-1]))
    assert scored(jogged).gain < 0.0
    # Nor would it be told if such a block counted by more than there was to predict.
    monkeypatch.setattr(scoring, "no_more_than", lambda size, *sums: sums)
    assert scored(jogged).p_value > 0.1


def test_rows_of_motion_that_the_rest_tells_count_in_full(jogged):
    known = [foretold(f.project[~f.train]) for f in cross_fit(jogged).halves]
    assert min(x.min() for x in known) < 1e-3
    assert all(np.mean(x == 1.0) > 0.9 for x in known)
