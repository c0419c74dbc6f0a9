"""A base that gives way is named by what it does to all joints, and a soft joint stays one."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
import scipy
from elbow import ask, elbow, elbow_log, fitted, passing
from scipy.interpolate import make_interp_spline
from swaying import given_motion, log_on_soft_base, log_with_soft_joint, on_hinges

from jaxswarm.diagnose.decision.competing import accepted, choose
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import find_term
from jaxswarm.effects import get_law
from jaxswarm.effects.hinged_base import poses
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward import sway_response
from jaxswarm.identify.forward.base_swing import below_cutoff, swung
from jaxswarm.identify.forward.body import Body
from jaxswarm.identify.forward.compliance import compliance_columns, compliance_slopes
from jaxswarm.identify.forward.sway_response import SwayResponse
from jaxswarm.identify.report.summary import term_parameters
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


def test_an_arm_that_swings_on_its_base_is_told_with_its_frequencies():
    """The turn by its moment alone took 0.36 off the first joint and put other laws beside it."""
    soft, inertia = np.array([2e-3, 1.2e-3]), 0.3
    best, rivals, found = chosen(log_on_soft_base(*soft, inertia=inertia))
    assert (best.candidate.term.effect, rivals) == ("base_compliance", [])
    after = refit_with(found, best)
    values = find_term(after, best.candidate.term).values
    model = on_hinges()
    every = [pin.crba(model, model.createData(), np.r_[0, 0, q]) for q in poses(elbow())]
    mean = np.mean([np.diag(mass)[:2] for mass in every], axis=0)
    often = np.sqrt(1.0 / soft / (mean + inertia)) / (2.0 * np.pi)
    assert [values["cx"], values["cy"]] == pytest.approx(soft, rel=0.1)
    assert [values["fx"], values["fy"]] == pytest.approx(often, rel=0.06)
    assert values["zeta"] == pytest.approx(0.1, abs=0.03)
    assert (after.fit.sigma < 0.65 * found.fit.sigma).all()


@pytest.mark.parametrize(("seed", "share"), [(2, 0.6), (3, 0.5)])
def test_a_soft_base_is_asked_with_the_masses_that_no_joint_of_a_level_arm_feels(seed, share):
    """About what stands in the model for them it took 0.27 and 0.15 off."""
    found = fitted(elbow_log(Term("base_compliance", values={"cx": 1e-3, "cy": 0.0}), seed=seed))
    (base,) = passing(ask(found, "base_compliance"))
    assert base.share > share
    after = refit_with(found, base)
    assert after.fit.sigma[0] < 0.65 * found.fit.sigma[0]


STILL = Term("base_compliance", values={"cx": 1.0, "cy": 0.0})
SWINGING = Term(
    "base_compliance", values={"cx": 2e-5, "cy": 1e-5, "fx": 9.0, "fy": 12.0, "zeta": 0.05}
)


def test_a_swing_that_does_not_show_is_not_told():
    values = get_law("base_compliance").nominal()
    assert term_parameters(Term("base_compliance", values=values), elbow()).keys() == {
        *("cx", "cy", "kx", "ky")
    }
    slow = Term("base_compliance", values={**values, "fy": 8.0})
    assert {"fy", "zeta"} < term_parameters(slow, elbow()).keys()
    assert [p.name for p in slow.law.free(slow.values)] == ["fy", "zeta"]


def body_of_the_elbow() -> Body:
    motion, arm = fitted(elbow_log()).motions[0], elbow()
    pi = np.asarray(arm.parameters).ravel()
    return Body(arm, (motion.q, motion.dq, motion.ddq), motion, pi, None, None)


@pytest.mark.parametrize("term", [STILL, SWINGING], ids=["still", "swinging"])
def test_what_a_base_does_along_masses_is_the_slope_of_its_torque(term):
    body = body_of_the_elbow()
    along, alone = np.random.default_rng(0).normal(size=(len(body.pi), 2)), np.eye(3)[0]
    every = np.column_stack([body.pi, along])
    response = SwayResponse(body.arm, body.moved, body.motion, every)
    own, by = np.split(np.delete(response.further(term, alone), [2, 3], axis=2), [2], axis=2)
    columns = compliance_columns(term, body)
    np.testing.assert_allclose(own, columns, atol=1e-9 * np.abs(columns).max())
    np.testing.assert_allclose(own, response.columns(term, alone), atol=1e-9 * np.abs(own).max())
    # Without a swing the torque is quadratic in the masses: half of the difference both ways is exact.
    step = 1.0 if term is STILL else 1e-4
    for k, one in enumerate(along.T):
        ahead, behind = (
            compliance_columns(term, replace(body, pi=body.pi + way * step * one))
            for way in (1.0, -1.0)
        )
        slope = (ahead - behind) / (2.0 * step)
        near = 1e-9 if term is STILL else 1e-5
        np.testing.assert_allclose(
            by[:, :, 2 * k : 2 * k + 2], slope, atol=near * np.abs(slope).max()
        )
    slopes = compliance_slopes(term, body)[0] @ along
    soft = [term.values["cx"], term.values["cy"]]
    told = by.reshape(*by.shape[:2], 2, 2) @ soft
    np.testing.assert_allclose(told, slopes, atol=1e-9 * np.abs(slopes).max())


@pytest.mark.parametrize("term", [STILL, SWINGING], ids=["still", "swinging"])
def test_what_a_base_does_is_the_same_however_long_the_log(term, monkeypatch):
    body = body_of_the_elbow()
    whole = compliance_columns(term, body), *compliance_slopes(term, body)
    for module in (sway_response, logged):
        monkeypatch.setattr(module, "BLOCK", 700)
    again = compliance_columns(term, body), *compliance_slopes(term, body)
    for one, two in zip(whole, again, strict=True):
        if one is not None:
            np.testing.assert_allclose(two, one, atol=1e-12 * np.abs(one).max())


def test_a_base_under_an_arm_of_one_inertia_swings_as_scipy_says():
    body, often = body_of_the_elbow(), np.array([9.0, 12.0])
    t = np.arange(1000) / 1000.0
    rest = 1e-3 * np.stack([np.sin(8.0 * t), np.sin(20.0 * t + 1.0)], axis=1)
    motion = replace(body.motion, t=t, torque_cutoff=np.inf)
    still = below_cutoff(rest[:, :, None], motion)
    found = swung(still, motion, np.zeros((len(t), 2, 2)), SWINGING)
    for axis, omega in enumerate(2.0 * np.pi * often):
        angle, rate, push = still[0, :, axis, 0]
        begin = angle - 0.1 / omega * rate - push / omega**2, rate
        law = scipy.signal.StateSpace(
            [[0.0, 1.0], [-(omega**2), -0.1 * omega]],
            [[0.0], [omega**2]],
            np.eye(2),
            np.zeros((2, 1)),
        )
        told = scipy.signal.lsim(law, rest[:, axis], t, begin)[1]
        for order in range(2):
            near = 0.02 * np.abs(told[:, order]).max()
            np.testing.assert_allclose(found[:, order, axis, 0], told[:, order], atol=near)


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
    assert best.candidate.term.place == ("joint_elasticity", 1, None)
    # A base that swings, with fourteen numbers, does nearly as much of what so loud a drive still shows.
    assert {s.candidate.term.effect for s in rivals} <= {"base_compliance"}


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
    body = Body(elbow(), tuple(moved), motion, pi, None, None)
    columns = compliance_columns(Term("base_compliance"), body)
    inside = slice(50, -50)
    np.testing.assert_allclose(
        (columns @ c)[inside], change[inside], atol=1e-3 * np.abs(change).max()
    )
