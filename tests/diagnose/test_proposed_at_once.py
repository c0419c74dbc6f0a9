"""Candidates that threads build and score together are those of one thread, to the bit."""

import numpy as np
import pytest
from elbow import elbow_log, fitted

from jaxswarm import cores
from jaxswarm.diagnose.candidates import propose
from jaxswarm.diagnose.candidates.eligible import eligible_terms
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.evaluate import score_terms
from jaxswarm.diagnose.folds import free_parts
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.effects.kinds import TransmissionLaw


@pytest.fixture(scope="module")
def declared():
    return fitted(elbow_log())


def asked(found):
    """Scores of transmissions and of errors of encoders, which share what is known of the motion."""
    names = {"joint_elasticity", "backlash", "encoder_offset", "base_tilt", "torque_offset"}
    terms = [t for t in eligible_terms(found.model, found.motions) if t.effect in names]
    return score_terms(Linearization(found, cross_fit(found)), terms, 0)


def test_two_cores_find_what_one_finds(monkeypatch, declared):
    monkeypatch.setattr(free_parts, "_AT_ONCE", 2**14)  # several parts of so short a log
    found = []
    for count in (1, 2):
        monkeypatch.setattr(cores, "count", lambda count=count: count)
        for rigid in declared.rigids:
            rigid.sensed.clear()
        found.append(asked(declared))
    assert len(found[0]) == len(found[1]) > 10
    for one, two in zip(*found, strict=True):
        assert one.candidate.term == two.candidate.term
        assert (one.gain, one.p_value, one.share) == (two.gain, two.p_value, two.share)
        np.testing.assert_array_equal(one.coefficients, two.coefficients)


def test_transmissions_have_a_thread_of_their_own_while_columns_are_kept(monkeypatch, declared):
    lin = Linearization(declared, cross_fit(declared))
    terms = eligible_terms(declared.model, declared.motions)
    apart = {t.effect for t in terms if propose._goes_apart(lin, t)}
    assert apart and all(isinstance(t.law, TransmissionLaw) for t in terms if t.effect in apart)
    monkeypatch.setattr(propose, "is_kept", lambda motion: False)
    assert not any(propose._goes_apart(lin, t) for t in terms)
