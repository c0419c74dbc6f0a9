"""What laws on a joint see along a log is made once, and told apart by all that it follows from."""

from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.effects.sample import Sample
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward import joint_series
from jaxswarm.identify.forward.columns import term_columns
from jaxswarm.identify.forward.joint_series import Load
from jaxswarm.identify.synthetic import fourier_motion
from jaxswarm.logs import log_from_arrays
from jaxswarm.logs.motion import Filtering, prepare

WIDTH = (0.01, 0.02)


@pytest.fixture
def motion():
    t, q, dq, _ = fourier_motion(2, np.random.default_rng(1), 6.0, 125.0)
    return prepare(log_from_arrays(t, q, dq, joints=("joint1", "joint2")), Filtering(20.0, 10.0))


@pytest.fixture
def made(monkeypatch):
    """Joints whose series were made, and the widths of signs that were."""
    joints, widths = [], []
    plain, signs = joint_series._of_motion, joint_series._signs

    def counted(motion, joint, other):
        joints.append(joint)
        return plain(motion, joint, other)

    def signed(motion, width, joint, other):
        widths.append(width[joint])
        return signs(motion, width, joint, other)

    monkeypatch.setattr(joint_series, "_of_motion", counted)
    monkeypatch.setattr(joint_series, "_signs", signed)
    return joints, widths


def columns(name, motion, width=WIDTH, load=None, values=None):
    return term_columns(Term(name, 0, values=values or {}), motion, width, load)


def test_laws_of_a_joint_see_what_was_made_for_the_first(motion, made):
    for name in ("viscous_friction", "coulomb_friction", "rotor_inertia"):
        columns(name, motion)
    columns("coulomb_friction", replace(motion, torque_noise=np.ones(2)))
    assert made == ([0], [0.01])


def test_another_width_or_motion_is_seen_as_it_is(motion, made):
    sharp = columns("coulomb_friction", motion)
    wide = columns("coulomb_friction", motion, (0.5, 0.5))
    back = columns("coulomb_friction", replace(motion, dq=-motion.dq))
    # A width more is a sign more: a fit tries thousands.
    assert made == ([0, 0], [0.01, 0.5, 0.01])
    np.testing.assert_allclose(wide[:, 0], np.tanh(motion.dq[:, 0] / 0.5), atol=1e-12)
    np.testing.assert_array_equal(back, -sharp)


def test_a_load_is_that_of_the_model_that_asks(motion, made):
    told = []
    for size in (1.0, 3.0):
        load = Load(*(np.full(motion.q.shape, size),) * 2)
        told.append(columns("load_dependent_friction", motion, load=load, values={"inertial": 1.0}))
    np.testing.assert_allclose(told[1], 3.0 * told[0])
    assert made == ([0], [0.01])


def test_what_is_kept_is_bounded(motion, monkeypatch):
    monkeypatch.setattr(joint_series, "_MOST", len(Sample._fields) * 1024 * 3)
    for size in np.linspace(0.1, 0.9, 9):
        columns("coulomb_friction", motion, (size, size))
    assert len(joint_series._kept) == 3
