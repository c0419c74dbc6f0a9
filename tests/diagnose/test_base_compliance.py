"""A base that gives way is named by what it does to all joints, and a soft joint stays one."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from elbow import ask, elbow, elbow_log, fitted, passing
from scipy.interpolate import make_interp_spline
from swaying import given_motion, log_on_soft_base, log_with_soft_joint, on_hinges

from jaxswarm.diagnose.decision.competing import accepted, choose
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.effects import get_law
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward import sway_response
from jaxswarm.identify.forward.compliance import compliance_columns, compliance_slopes
from jaxswarm.identify.forward.sway_response import compliance_along
from jaxswarm.logs.filtering import Decimator
from jaxswarm.logs.motion import Motion
from jaxswarm.robot import logged

RIVALS = ("joint_elasticity", "base_tilt", "encoder_offset", "link_geometry", "backlash")


def chosen(log):
    """What is chosen among all that stands or lags otherwise, its rivals, and the first fit."""
    found = fitted(log)
    best, rivals = choose(
        passing(ask(found, "base_compliance", *RIVALS)), Rules(), cross_fit(found)
    )
    return best, rivals, found


def test_a_soft_base_is_named_with_its_compliance():
    best, rivals, found = chosen(log_on_soft_base(1e-3, 3e-4))
    assert (best.candidate.term.effect, rivals) == ("base_compliance", [])
    after = refit_with(found, best)
    values = find_term(after, best.candidate.term).values
    assert values["cx"] == pytest.approx(1e-3, rel=0.15)  # to first order: 9 to 10 % too soft
    assert values["cy"] == pytest.approx(3e-4, rel=0.4)
    assert (after.fit.sigma < 0.95 * found.fit.sigma).all()


@pytest.mark.parametrize(("seed", "share"), [(2, 0.6), (3, 0.5)])
def test_a_soft_base_is_asked_with_the_masses_that_no_joint_of_a_level_arm_feels(seed, share):
    """About what stands in the model for them it took 0.27 and 0.15 off."""
    found = fitted(elbow_log(Term("base_compliance", values={"cx": 1e-3, "cy": 0.0}), seed=seed))
    (base,) = passing(ask(found, "base_compliance"))
    assert base.share > share
    after = refit_with(found, base)
    assert after.fit.sigma[0] < 0.65 * found.fit.sigma[0]


def test_what_a_base_does_along_masses_is_the_slope_of_its_torque():
    motion, arm = fitted(elbow_log()).motions[0], elbow()
    moved, pi = (motion.q, motion.dq, motion.ddq), np.asarray(arm.parameters).ravel()
    along = np.random.default_rng(0).normal(size=(len(pi), 2))
    law = get_law("base_compliance")
    own, by = np.split(compliance_along(law, arm, moved, pi, motion, along), [2], axis=2)
    columns = compliance_columns(law, arm, moved, pi, motion)
    np.testing.assert_allclose(own, columns, atol=1e-9 * np.abs(columns).max())
    # The torque is quadratic in the masses: half of the difference between both ways is exact.
    for k, one in enumerate(along.T):
        ahead, behind = (
            compliance_columns(law, arm, moved, pi + way * one, motion) for way in (1.0, -1.0)
        )
        slope = (ahead - behind) / 2.0
        np.testing.assert_allclose(
            by[:, :, 2 * k : 2 * k + 2], slope, atol=1e-9 * np.abs(slope).max()
        )
    term = Term("base_compliance", values={"cx": 1.0, "cy": 0.0})
    slopes = compliance_slopes(term, arm, moved, pi, motion) @ along
    np.testing.assert_allclose(by[:, :, ::2], slopes, atol=1e-4 * np.abs(slopes).max())


def test_what_a_base_does_is_the_same_however_long_the_log(monkeypatch):
    motion, arm = fitted(elbow_log()).motions[0], elbow()
    moved, pi = (motion.q, motion.dq, motion.ddq), np.asarray(arm.parameters).ravel()
    given = get_law("base_compliance"), arm, moved, pi, motion, np.eye(len(pi))[:, :1]
    whole = compliance_along(*given)
    for module in (sway_response, logged):
        monkeypatch.setattr(module, "BLOCK", 700)
    np.testing.assert_allclose(compliance_along(*given), whole, atol=1e-12 * np.abs(whole).max())


def test_a_soft_second_joint_is_not_taken_for_its_base():
    best, rivals, _ = chosen(log_with_soft_joint(1, 800.0, 8.0))
    assert (best.candidate.term.place, rivals) == (("joint_elasticity", 1, None), [])


def test_a_soft_joint_whose_own_drive_is_loud_is_not_taken_for_its_base():
    """By its own joint alone it does not pass, and the base, told by the joint that shows it best, does."""
    log = log_with_soft_joint(1, 800.0, 8.0)
    tau = log.tau.copy()
    tau[:, 1] += 6.0 * np.random.default_rng(2).normal(size=len(tau))
    found = fitted(replace(log, tau=tau))
    scores = ask(found, "base_compliance", *RIVALS[:2])
    assert [s.candidate.term.effect for s in passing(scores)] == ["base_compliance"]
    best, rivals = choose(accepted(scores, Rules()), Rules(), cross_fit(found))
    assert (best.candidate.term.place, rivals) == (("joint_elasticity", 1, None), [])


def test_a_firm_base_is_left_as_it_is():
    assert not passing(ask(fitted(elbow_log()), "base_compliance"))


def test_columns_are_what_pinocchio_says_of_a_base_that_turns_by_its_moment():
    t, *moved = given_motion()
    model, c = on_hinges(), np.array([2e-7, 1e-7])
    data = model.createData()
    held = [
        pin.rnea(model, data, *(np.r_[0, 0, x] for x in now)) for now in zip(*moved, strict=True)
    ]
    turns = make_interp_spline(t, -c * np.array(held)[:, :2], k=5)
    along = [turns.derivative(k)(t) for k in range(3)]
    whole = [np.column_stack(pair) for pair in zip(along, moved, strict=True)]
    swayed = [pin.rnea(model, data, *now) for now in zip(*whole, strict=True)]
    change = np.array(swayed)[:, 2:] - np.array(held)[:, 2:]
    motion = Motion("given", elbow().joints, t, *moved, None, {}, Decimator(np.ones(1), 1),
                    (np.inf,) * 3, np.inf, t[1], None)  # fmt: skip
    pi = np.asarray(elbow().parameters).ravel()
    columns = compliance_columns(get_law("base_compliance"), elbow(), tuple(moved), pi, motion)
    inside = slice(50, -50)
    np.testing.assert_allclose(
        (columns @ c)[inside], change[inside], atol=1e-3 * np.abs(change).max()
    )
