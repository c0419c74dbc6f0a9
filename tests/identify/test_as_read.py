"""What follows from a log as its encoders should have said it is made once for every value of their errors."""

from dataclasses import replace

import numpy as np
from small_problems import make_motion, planar_arm

from jaxswarm.effects.term import Term
from jaxswarm.identify.forward import columns, sensitivity
from jaxswarm.identify.forward.columns import rigid_of
from jaxswarm.identify.forward.link_lag import as_read, true_motion
from jaxswarm.identify.forward.measuring_chain import assemble

ARM = planar_arm()
PI = np.asarray(ARM.parameters).ravel()
SOFT = Term("joint_elasticity", 1, values={"k": 60.0, "d": 0.5})
DRY = tuple(Term("coulomb_friction", j, values={"fc": 0.5}) for j in (0, 1))
WRONG = Term("encoder_eccentricity", 0, values={"s1": 0.02, "c1": 0.01})
TERMS = (*DRY, SOFT, WRONG)


def arm_log():
    motion = make_motion(ARM, lambda q, dq, ddq: 0.1 * dq, length=800)
    return motion, rigid_of(ARM, motion)


def test_a_log_is_read_once_for_the_same_errors():
    motion, rigid = arm_log()
    true, known = as_read(TERMS, motion, rigid)
    again, same = as_read((WRONG, *DRY), motion, rigid)
    assert same is known and again.q is true.q
    np.testing.assert_array_equal(true.q, true_motion(TERMS, motion).q)
    assert np.abs(true.q - motion.q)[:, 0].max() > 0.01
    other = replace(WRONG, values={"s1": 0.03, "c1": 0.01})
    _, third = as_read((*DRY, SOFT, other), motion, rigid)
    assert third is not known
    assert as_read(DRY, motion, rigid) == (motion, rigid)
    # What holds for one log says nothing of it by another clock.
    moved = replace(motion, q=motion.q + 0.1)
    assert as_read(TERMS, moved, rigid)[1] is None
    rigid.forget()
    assert as_read((*DRY, SOFT, other), motion, rigid)[1] is not third


def test_columns_beside_an_error_are_those_without_what_is_known_and_made_once(monkeypatch):
    motion, rigid = arm_log()
    made = []
    rigid_columns = sensitivity.rigid_columns
    monkeypatch.setattr(
        sensitivity,
        "rigid_columns",
        lambda *of, **more: made.append(of) or rigid_columns(*of, **more),
    )

    def along(width, known):
        return assemble(ARM, TERMS, motion, (width, width), PI, known, decimate=True)

    bare = along(0.05, None)
    made.clear()
    np.testing.assert_allclose(along(0.05, rigid), bare, atol=1e-12)
    first = len(made)
    np.testing.assert_allclose(along(0.1, rigid), along(0.1, None), atol=1e-12)
    assert first > 0
    made.clear()
    along(0.2, rigid)
    assert not made


def test_decimated_columns_of_a_log_are_made_when_they_are_asked_for(monkeypatch):
    made, low = [], columns.low_columns
    monkeypatch.setattr(columns, "low_columns", lambda *of: made.append(of) or low(*of))
    motion, rigid = arm_log()
    assert not made
    assert rigid.low is rigid.low and len(made) == 1
    assert rigid.low.shape[1:] == (2, 20)
