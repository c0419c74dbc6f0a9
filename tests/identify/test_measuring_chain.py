"""What a torque's filter does to the rigid body is made once; a law of one joint stays with its joint."""

from dataclasses import replace
from types import SimpleNamespace

import jax.numpy as jnp
import numpy as np
import pytest
from small_problems import make_motion, planar_arm

from jaxswarm.effects.base import REGISTRY
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward import measuring_chain
from jaxswarm.identify.forward.columns import rigid_of
from jaxswarm.identify.forward.measuring_chain import assemble
from jaxswarm.identify.forward.model import Model
from jaxswarm.identify.forward.written_down import report_own
from jaxswarm.logs.motion import Filtering
from jaxswarm.testing import check_effect

ARM = planar_arm()
PI = np.asarray(ARM.parameters).ravel()
LATE = Term("torque_lag", None, values={"tc": 0.02, "seconds": 0.003})
LOUD = Term("drive_gain", 1, values={"gain": 1.2})
DRY = Term("coulomb_friction", 1, values={"fc": 0.5})


@pytest.fixture(scope="module")
def motion():
    return make_motion(ARM, lambda q, dq, ddq: 0.0 * q, length=400)


@pytest.fixture
def asked(monkeypatch):
    """The shapes of all torques that were asked for as they are written down, joints and all."""
    shapes, made = [], measuring_chain.report
    monkeypatch.setattr(
        measuring_chain,
        "report",
        lambda terms, motion, block: shapes.append(block.shape) or made(terms, motion, block),
    )
    return shapes


def test_columns_of_one_joint_are_those_of_all(motion):
    own = np.stack([motion.dq[:, 1], motion.q[:, 1]], axis=1)
    placed = np.zeros((len(own), 2, 2))
    placed[:, 1] = own
    every = measuring_chain.report((LATE, LOUD), motion, placed)
    np.testing.assert_allclose(report_own((LATE, LOUD), motion, own, 1), every[:, 1], atol=1e-12)
    assert np.all(every[:, 0] == 0.0)


def test_a_width_leaves_the_rigid_columns_as_they_were_written_down(motion, asked):
    rigid = rigid_of(ARM, motion)

    def columns(width, late=LATE):
        terms = (DRY, late)
        return assemble(ARM, terms, motion, (width, width), PI, rigid, decimate=True)

    first, second = columns(0.05), columns(0.2)
    assert len(asked) == 1
    np.testing.assert_array_equal(first[:, :, :20], second[:, :, :20])
    assert np.abs(first[:, 1, 20] - second[:, 1, 20]).max() > 0.01
    later = columns(0.2, Term("torque_lag", None, values={"tc": 0.04, "seconds": 0.003}))
    assert len(asked) == 2
    assert np.abs(later[:, :, :20] - second[:, :, :20]).max() > 0.01
    fresh = assemble(ARM, (DRY, LATE), motion, (0.2, 0.2), PI, None, decimate=True)
    np.testing.assert_allclose(second, fresh, atol=1e-9)


def cross_talk(**fields) -> MeasurementLaw:
    """Each drive writes down a part of the mean torque too."""
    return MeasurementLaw(
        name="cross_talk",
        scope="global",
        parameters=(Parameter("part", "1", 0.0, 0.5, False, 0.0, "of the mean torque"),),
        summary="trial",
        reference="none",
        report=lambda p, x, step: x + p["part"] * jnp.mean(x, axis=1, keepdims=True),
        **fields,
    )


def test_a_law_that_mixes_joints_sees_all_of_them(motion, monkeypatch):
    monkeypatch.setitem(REGISTRY, "cross_talk", cross_talk())
    mixing = Term("cross_talk", None, values={"part": 0.3})
    rigid = rigid_of(ARM, motion)
    columns = assemble(ARM, (DRY, mixing), motion, (0.05, 0.05), PI, rigid, decimate=True)
    own = columns[:, :, 20]
    np.testing.assert_allclose(own[:, 0], own[:, 1] * 0.15 / 1.15, atol=1e-12)
    plain = Model(ARM, (DRY,), (0.05, 0.05), Filtering(), (1.0, 1.0))
    assert not plain.on_joint(0).terms
    mixed = replace(plain, terms=(*plain.terms, mixing))
    assert mixed.on_joint(0) == mixed


def test_what_sensors_pick_up_of_each_other_is_the_true_torque():
    """Both at once, before the gain of a drive: the second would hear of itself through the first."""
    terms = (
        LOUD,
        Term("torque_crosstalk", 0, 1, values={"c": 0.3}),
        Term("torque_crosstalk", 1, 0, values={"c": 0.5}),
    )
    true = np.random.default_rng(0).normal(size=(7, 2, 3))
    wanted = np.stack(
        [true[:, 0] + 0.3 * true[:, 1], 1.2 * (true[:, 1] + 0.5 * true[:, 0])], axis=1
    )
    motion = SimpleNamespace(rate=100.0)
    np.testing.assert_allclose(measuring_chain.report(terms, motion, true), wanted, atol=1e-12)
    plain = Model(ARM, (DRY, *terms[1:]), (0.05, 0.05), Filtering(), (1.0, 1.0))
    assert plain.on_joint(0) == plain


def test_a_measurement_of_a_pair_says_what_it_does_to_its_torque():
    with pytest.raises(ValueError, match="an excess, or a report of both torques"):
        check_effect(replace(cross_talk(), scope="pair", report=MeasurementLaw.report))
    own = replace(cross_talk(), scope="pair", report=lambda p, x, step: x[:, 0] + p["part"])
    with pytest.raises(AssertionError, match="is not linear in the torque"):
        check_effect(own)


def test_a_law_that_says_it_does_not_mix_is_tried(monkeypatch):
    check_effect(cross_talk())
    false = replace(cross_talk(), report=lambda p, x, step: x * (1.0 + p["part"] * (x.ndim > 1)))
    check_effect(false)
    with pytest.raises(AssertionError, match="writes down a torque by another one"):
        check_effect(replace(false, alike=True))
