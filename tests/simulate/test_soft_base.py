"""An arm on springs accelerates as in Pinocchio, and comes to rest where its weight puts it."""

import jax.numpy as jnp
import numpy as np
import pinocchio as pin
from arms import two_joint_arm

from jaxswarm.effects import get_law
from jaxswarm.effects.hinged_base import poses
from jaxswarm.robot.trig import polynomial_sincos
from jaxswarm.simulate import Acting, Drive, accelerations, make_plant, rest
from jaxswarm.simulate.acceleration import State
from jaxswarm.simulate.soft_base import BASE_INERTIA

SOFT = {"cx": 2e-4, "cy": 1e-4}


def on_hinges(robot) -> pin.Model:
    model, above = pin.Model(), 0
    model.gravity.linear = np.asarray(robot.gravity, float)
    for hinge, name in ((pin.JointModelRX(), "x"), (pin.JointModelRY(), "y")):
        above = model.addJoint(above, hinge, pin.SE3.Identity(), name)
    for j, name in enumerate(robot.joints):
        hinge = pin.JointModelRevoluteUnaligned(np.asarray(robot.axis[j], float))
        place = pin.SE3(
            np.asarray(robot.rotation[j], float), np.asarray(robot.translation[j], float)
        )
        above = model.addJoint(above, hinge, place, name)
        body = pin.Inertia.FromDynamicParameters(np.asarray(robot.parameters[j], float))
        model.appendBodyToJoint(above, body, pin.SE3.Identity())
    return model


def test_an_arm_on_a_soft_base_accelerates_as_in_pinocchio():
    robot = two_joint_arm()
    plant = make_plant(robot, [Acting("base_compliance", values=SOFT)])
    model = on_hinges(robot)
    turns, swing = np.array([0.01, -0.02]), np.array([0.3, 0.2])
    q, dq, tau = np.array([0.3, -0.5]), np.array([0.4, 0.9]), np.array([20.0, -5.0])
    state = State(*(tuple(jnp.asarray(x)) for x in (q, dq, turns, swing)), ())
    drive = Drive(tuple(tau), (0.0, 0.0), (25.0, 25.0))
    links, base = accelerations(plant, state, drive, 0.0, polynomial_sincos)
    place = np.r_[turns, q]
    stiffness = 1.0 / np.array([SOFT["cx"], SOFT["cy"]])
    mean = mean_inertia(robot)
    model.armature = np.r_[BASE_INERTIA * mean, 0, 0]
    data = model.createData()
    damping = 2 * get_law("base_compliance").nominal()["zeta"]
    held = -stiffness * turns - damping * np.sqrt(stiffness * 1.1 * mean) * swing
    wanted = pin.aba(model, data, place, np.r_[swing, dq], np.r_[held, tau])
    np.testing.assert_allclose(np.r_[base, links], wanted, rtol=1e-6, atol=1e-6)


def mean_inertia(robot) -> np.ndarray:
    """About the axes of its base, over the poses that a swing is told of."""
    model = on_hinges(robot)
    every = (pin.crba(model, model.createData(), np.r_[0, 0, q]) for q in poses(robot))
    return np.mean([np.diag(mass)[:2] for mass in every], axis=0)


def test_its_base_has_the_inertia_with_which_it_swings_as_often_as_is_told():
    robot, often, zeta = two_joint_arm(), np.array([5.0, 4.0]), 0.1
    told = {**SOFT, "fx": often[0], "fy": often[1], "zeta": zeta}
    base = make_plant(robot, [Acting("base_compliance", values=told)]).base
    omega, stiffness = 2 * np.pi * often, 1.0 / np.array([SOFT["cx"], SOFT["cy"]])
    whole = base.inertia + mean_inertia(robot)
    np.testing.assert_allclose(np.sqrt(stiffness / whole), omega, rtol=1e-9)
    np.testing.assert_allclose(base.damping / whole, 2 * zeta * omega, rtol=1e-9)


def test_it_starts_where_its_weight_turns_the_base():
    robot = two_joint_arm()
    plant = make_plant(robot, [Acting("base_compliance", values=SOFT)])
    q = np.array([0.3, -0.5])
    start = rest(plant, jnp.asarray(q))
    model, none = on_hinges(robot), np.zeros(4)
    held = pin.rnea(model, model.createData(), np.r_[0, 0, q], none, none)[:2]
    np.testing.assert_allclose(start.motor_q, -np.array([2e-4, 1e-4]) * held, rtol=1e-9)
    assert not np.any(start.motor_dq)
