"""What a joint's own motion does to the rigid torque, and how a lag follows the rigid parameters."""

import jax
import numpy as np
import pytest
from small_problems import make_motion, planar_arm

from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.free_parameters import (
    Place,
    free_parameters,
    read,
    tangents,
    width_parameter,
    write,
)
from jaxswarm.identify.estimation.problem import Problem
from jaxswarm.identify.forward import sensitivity
from jaxswarm.identify.forward.columns import rigid_of
from jaxswarm.identify.forward.link_lag import flank_compression, lag_slopes, link_motion
from jaxswarm.identify.forward.sensitivity import sensitivity_of
from jaxswarm.robot import inverse_dynamics
from jaxswarm.robot.logged import rigid_columns

ARM = planar_arm()
PI = np.asarray(ARM.parameters).ravel()


@pytest.mark.parametrize("joint", [0, 1])
def test_sensitivities_are_the_derivatives_of_inverse_dynamics(joint):
    motion = make_motion(ARM, length=40)
    sensed = sensitivity_of(ARM, motion, joint)
    along = np.eye(2)[joint]

    def slope(argument, state):
        def torque(x):
            moved = list(state)
            moved[argument] = state[argument] + x * along
            return inverse_dynamics(ARM, *moved)

        return jax.jvp(torque, (0.0,), (1.0,))[1]

    state = (motion.q, motion.dq, motion.ddq)
    torque, *slopes = sensed.at(PI)
    np.testing.assert_allclose(torque, motion.tau, atol=1e-9)
    for argument, found in enumerate(slopes):
        exact = jax.vmap(lambda *s, a=argument: slope(a, s))(*state)
        np.testing.assert_allclose(found, exact, atol=1e-5 * np.abs(exact).max())
    own = sensed.own() @ PI[10 * joint :]
    np.testing.assert_allclose(own, np.stack([x[:, joint] for x in (torque, *slopes)]))
    np.testing.assert_allclose(sensed.inertia(PI), slopes[2][:, joint])


SOFT = [
    Term("joint_elasticity", 1, values={"k": 60.0, "d": 0.5}),
    Term("backlash", 1, values={"gap": 0.004, "flank": 12.0, "blur": 0.0}),
]


@pytest.mark.parametrize("term", SOFT, ids=lambda t: t.effect)
def test_slopes_through_a_lag_are_those_of_the_linearized_torque(term):
    motion = make_motion(ARM, length=400)

    def through_lag(pi):
        sensed = sensitivity_of(ARM, motion, 1)
        _, *by = sensed.at(PI)  # first order about the motor's motion at the given parameters
        moved = link_motion(ARM, (term,), motion, pi)
        lags = (motion.q - moved[0], motion.dq - moved[1], motion.ddq - moved[2])
        return -sum(b * e[:, 1:] for b, e in zip(by, lags, strict=True))

    slopes = lag_slopes(ARM, (term,), motion, PI)
    for column in (11, 19):  # first moment and inertia of the second link
        step = 1e-6 * np.eye(len(PI))[column]
        difference = (through_lag(PI + step) - through_lag(PI - step)) / 2e-6
        scale = np.abs(difference).max()
        # An impact that falls on another step of the integrator is a jump, and no slope.
        off = np.abs(slopes[:, :, column - 10] - difference).max(axis=1) > 0.02 * scale
        assert off.mean() < 0.02


def test_flank_is_pressed_by_the_torque_over_its_stiffness():
    motion = make_motion(ARM, length=200)
    pressed = [
        flank_compression(ARM, Term("backlash", 1, values={"gap": 0.01, "flank": f}), motion, PI)
        for f in (20.0, 40.0)
    ]
    assert pressed[0] == pytest.approx(4.0 * pressed[1])
    inertia = np.median(sensitivity_of(ARM, motion, 1).inertia(PI))
    torque = np.median(np.abs(motion.tau[:, 1]))
    assert pressed[0] == pytest.approx(torque / inertia / (2 * np.pi * 20.0) ** 2, rel=1e-6)


def test_tangents_of_one_law_are_those_of_the_whole_model():
    motion = make_motion(ARM, length=300)
    terms = (
        Term("viscous_friction", 0, values={"b": 2.0}),
        Term("torque_ripple", 1, values={"sine": 0.5, "cosine": -0.2, "n": 9.0}),
        Term("load_dependent_friction", 0, values={"mu": 0.1, "inertial": 0.4}),
        Term("drive_gain", 1, values={"gain": 1.1}),
    )
    problem = Problem(ARM, (motion,), (rigid_of(ARM, motion),), False)
    moving = free_parameters(terms, [width_parameter((0,), (0.005, 0.1))])
    theta = np.concatenate([PI, [2.0, 0.5, -0.2, 0.1]])
    place = Place(terms, (0.02, 0.03))
    gain = moving[2]  # acts on all a joint reports: the whole model is made for it

    found = tangents(lambda p, k: problem.output(p, PI, theta, k), place, moving)
    whole = tangents(lambda p, k: problem.output(p, PI, theta, gain), place, moving)
    np.testing.assert_allclose(found, whole, atol=1e-6 * np.abs(whole).max())
    assert len(moving) == 4 and (np.abs(found).max(axis=(0, 1)) > 0).all()
    np.testing.assert_allclose(
        read(write(place, moving, read(place, moving)), moving), read(place, moving)
    )
    assert rigid_columns(ARM, motion.q, motion.dq, motion.ddq).shape[2] == len(PI)


@pytest.mark.parametrize("joints", [slice(None), slice(1, 2), slice(0, 1)])
@pytest.mark.parametrize("sets", [1, 3])
def test_torques_of_a_log_are_one_product_not_one_a_sample(joints, sets, monkeypatch):
    """One small product a sample took up to ten times as long."""
    motion = make_motion(ARM, length=40)
    sensed = sensitivity_of(ARM, motion, 1, rigid_of(ARM, motion))
    pis = PI if sets == 1 else PI * np.linspace(0.5, 2.0, sets)[:, None]
    columns, told = sensed._whole, sensed.at(pis, joints)
    for one, part, pi in zip(told, columns, (pis, *(pis[..., 10:],) * 3), strict=True):
        np.testing.assert_allclose(one, part[:, joints] @ pi.T, atol=1e-12 * np.abs(PI).max())
    if sets == 1:
        for one, other in zip(sensed.slopes(PI), sensed.at(PI)[1:], strict=True):
            np.testing.assert_array_equal(one, other)
    seen, times = [], sensitivity._times
    monkeypatch.setattr(sensitivity, "_times", lambda *at: seen.append(at) or times(*at))
    sensed.slopes(PI)
    assert len(seen) == 3  # a torque that nobody asks for is not made


def test_a_log_keeps_what_the_arm_that_was_asked_for_last_feels(monkeypatch):
    """An arm whose base is tilted is asked for by everybody: its differences are made once, not by each."""
    motion = make_motion(ARM, length=40)
    rigid, made = rigid_of(ARM, motion), []
    plain = sensitivity.rigid_columns
    monkeypatch.setattr(
        sensitivity, "rigid_columns", lambda *a, **k: made.append(a) or plain(*a, **k)
    )
    tilted = ARM.replace(gravity=np.array([0.5, 0.0, -9.8]))
    for arm in (tilted, tilted.replace(gravity=tilted.gravity.copy())):
        for joint in range(2):
            found = sensitivity_of(arm, motion, joint, rigid).at(PI)
            for own, alone in zip(found, sensitivity_of(arm, motion, joint).at(PI), strict=True):
                np.testing.assert_array_equal(own, alone)
    # Five moved ones of each joint and one as logged: of all four that keep nothing, and once of what is kept.
    assert len(made) == 4 * 6 + 2 * 5 + 1
    straight = sensitivity_of(ARM, motion, 1, rigid).at(PI)
    np.testing.assert_allclose(straight[0], motion.tau, atol=1e-9)
    assert list(rigid.sensed) == [1] and not np.array_equal(straight[0], found[0])
