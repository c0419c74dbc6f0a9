"""What a round need not search again."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jaxswarm.diagnose.candidates import propose
from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision import evaluate
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify.estimation.estimate import estimate
from jaxswarm.identify.synthetic import demo_case, synthetic_log
from jaxswarm.logs.motion import prepare
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


@pytest.mark.parametrize(
    ("share", "change", "kept"),
    [(0.01, 0.1, True), (0.01, 0.5, False), (0.09, 0.02, True), (0.11, 0.0, False)],
)
def test_columns_that_came_to_nothing_are_weighed_anew(share, change, kept):
    rng = np.random.default_rng(0)
    residuals, weight = rng.normal(size=(3, 40)), rng.uniform(1.0, 2.0, (40, 2))
    columns = rng.normal(size=(40, 2, 1))
    memory = Memory(least=0.2)
    shared = columns * weight[:, :, None]
    memory.keep_slight(Candidate(TERM, (shared,) * 3, 1), share, residuals, weight)
    other = np.where(np.arange(40)[:, None] < 5, 0.0, 3.0 * weight)
    again = memory.slight(TERM, (1.0 - change) * residuals, other)
    assert (again is not None) == kept
    if again:
        np.testing.assert_allclose(again.columns[0], columns * other[:, :, None])
        assert again.columns[0] is again.columns[2]
    assert memory.slight(Term("stribeck_friction", 0), residuals, other) is None


def test_columns_of_another_log_are_forgotten():
    memory = Memory(least=0.2)
    weight, residuals = np.ones((40, 2)), np.ones((3, 40))
    memory.keep_slight(Candidate(TERM, (np.ones((40, 2, 1)),) * 3, 1), 0.0, residuals, weight)
    arm, declared, _ = demo_case(rx60(), 1)
    motion = prepare(synthetic_log(arm, declared, 1, duration=6.0))
    memory.look_at([motion])
    assert memory.slight(TERM, residuals, weight) is None
    memory.laws["one"] = 1
    memory.look_at(
        [replace(motion, model_noise=np.zeros(3))]
    )  # what is known of its noise moves nothing
    assert memory.laws
    memory.look_at([replace(motion, q=motion.q.copy())])
    assert not memory.laws


def test_a_round_makes_no_columns_of_what_came_to_nothing(monkeypatch):
    """Scores are those of columns made anew, as long as the model is the same."""
    arm, declared, _ = demo_case(rx60(), 2)
    log = synthetic_log(arm, declared, 2, duration=8.0)
    found = estimate(
        rx60(), parse_terms("viscous_friction,coulomb_friction", rx60().joints), [prepare(log)]
    )
    terms = [
        Term(n, j) for n in ("joint_spring", "torque_offset", "encoder_offset") for j in range(3)
    ]
    terms.append(Term("base_tilt", None))
    asked = []

    def watched(lin, terms, key):
        asked.append(len(terms))
        return propose.propose_all(lin, terms, key)

    monkeypatch.setattr(evaluate, "propose_all", watched)
    memory, crossfit = Memory(least=0.2), cross_fit(found)
    first, again = (
        evaluate.score_terms(Linearization(found, crossfit, memory), terms, 0) for _ in range(2)
    )
    # Tilts and wrong encoders show on other joints too, so that their own does not tell whether they changed.
    assert asked[0] == len(terms) and 4 <= asked[1] < 7
    for one, other in zip(first, again, strict=True):
        assert one.candidate.term == other.candidate.term
        np.testing.assert_allclose(other.blocks, one.blocks, rtol=1e-9, atol=1e-9 * abs(one.gain))
