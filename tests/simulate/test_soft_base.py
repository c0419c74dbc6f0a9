"""An arm on springs accelerates as in Pinocchio, and comes to rest where its weight puts it."""

import jax.numpy as jnp
import numpy as np
import pinocchio as pin
from arms import two_joint_arm

from jaxswarm.robot.trig import polynomial_sincos
from jaxswarm.simulate import Acting, Drive, accelerations, make_plant, rest
from jaxswarm.simulate.acceleration import BASE_INERTIA, SWAY_DAMPING, State

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
    mass = np.diag(pin.crba(model, model.createData(), place))[:2]
    model.armature = np.r_[BASE_INERTIA * mass, 0, 0]
    data = model.createData()
    mass = mass + BASE_INERTIA * mass
    held = -stiffness * turns - 2 * SWAY_DAMPING * np.sqrt(stiffness * mass) * swing
    wanted = pin.aba(model, data, place, np.r_[swing, dq], np.r_[held, tau])
    np.testing.assert_allclose(np.r_[base, links], wanted, rtol=1e-6, atol=1e-6)


def test_it_starts_where_its_weight_turns_the_base():
    robot = two_joint_arm()
    plant = make_plant(robot, [Acting("base_compliance", values=SOFT)])
    q = np.array([0.3, -0.5])
    start = rest(plant, jnp.asarray(q))
    model, none = on_hinges(robot), np.zeros(4)
    held = pin.rnea(model, model.createData(), np.r_[0, 0, q], none, none)[:2]
    np.testing.assert_allclose(start.motor_q, -np.array([2e-4, 1e-4]) * held, rtol=1e-9)
    assert not np.any(start.motor_dq)
