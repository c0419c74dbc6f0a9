"""What a round need not search again."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.columns import rigid_of
from jaxswarm.identify.forward.sensitivity import sensitivity_of
from jaxswarm.identify.synthetic import demo_case, synthetic_log
from jaxswarm.logs.motion import prepare
from jaxswarm.logs.shifted import shift_motion
from jaxswarm.robot import rx60

TERM = Term("stribeck_friction", 1)
VALUES = [{"vs": 0.1, "delta": 2.0}]


def memory_of(residual, share, least):
    memory = Memory(least=least)
    memory.keep(TERM, residual[None], VALUES)
    memory.explained(TERM, share)
    return memory


@given(st.integers(0, 10**6), st.floats(0.0, 0.9), st.floats(0.01, 0.6))
def test_what_is_not_searched_again_explains_less_than_is_of_interest(seed, moved, least):
    """No direction that explained at most the share of the old residual explains more of the new one."""
    rng = np.random.default_rng(seed)
    old, law = rng.normal(size=(2, 40))
    law /= np.linalg.norm(law)
    share = (old @ law) ** 2 / (old @ old)
    # The worst change there is: along the law.
    new = old + moved * np.linalg.norm(old) * law * np.sign(old @ law)
    if memory_of(old, share, least).recall(TERM, new[None]) is not None and moved >= 0.05:
        assert (new @ law) ** 2 < least * (new @ new)


@pytest.mark.parametrize(
    ("share", "change", "known"),
    [(0.9, 0.04, True), (0.01, 0.1, True), (0.3, 0.1, False), (0.01, 1.2, False)],
)
def test_a_small_change_or_a_small_share_needs_no_search(share, change, known):
    old = np.random.default_rng(0).normal(size=200)
    memory = memory_of(old, share, 0.2)
    assert (memory.recall(TERM, (1.0 - change) * old[None]) is not None) == known
    assert memory.recall(Term("stribeck_friction", 0), old[None]) is None
    assert memory.recall(TERM, old[None, :100]) is None


def test_only_the_first_score_counts():
    """It was made on the residuals that are kept."""
    old = np.ones(50)
    memory = memory_of(old, 0.9, 0.2)
    memory.explained(TERM, 0.0)
    assert memory.recall(TERM, 0.9 * old[None]) is None
    memory.explained(Term("hysteresis", 1), 0.5)


def test_columns_of_a_log_are_kept_until_its_motion_is_another():
    arm, declared, _ = demo_case(rx60(), 1)
    motion = prepare(synthetic_log(arm, declared, 1, duration=6.0))
    memory = Memory()
    memory.look_at([motion])
    memory.laws["one"] = 1
    memory.look_at(
        [replace(motion, model_noise=np.zeros(3))]
    )  # what is known of its noise moves nothing
    assert memory.laws == {"one": 1}
    memory.look_at([replace(motion, q=motion.q.copy())])
    assert not memory.laws


def test_what_joints_do_to_columns_stands_for_one_clock():
    """Of 12,000 samples of seven joints it is 0.6 GB, and was kept of every clock that was tried."""
    arm, declared, _ = demo_case(rx60(), 1)
    motions = [prepare(synthetic_log(arm, declared, 1, duration=6.0))]
    motions.append(shift_motion(motions[0], 1e-3))
    memory, rigids = Memory(), [rigid_of(arm, m) for m in motions]
    for motion, rigid in zip(motions, rigids, strict=True):
        memory.look_at([motion], [rigid])
        for joint in range(3):
            sensitivity_of(arm, motion, joint, rigid).inertia(np.ones(30))
    assert not rigids[0].sensed and "full" not in vars(rigids[0])
    assert list(rigids[1].sensed) == [0, 1, 2]
    full = rigids[1].full
    memory.look_at([replace(motions[1], model_noise=np.zeros(3))], rigids[1:])
    assert list(rigids[1].sensed) == [0, 1, 2] and rigids[1].full is full
