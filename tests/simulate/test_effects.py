"""Effects in the simulation: every law balances the torque, soft joints and memories move right."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from arms import slide, two_joint_arm
from scipy.integrate import solve_ivp
from scipy.signal import lsim

from jaxswarm.effects import REGISTRY, TorqueLaw, make_sample
from jaxswarm.effects.series import remembered
from jaxswarm.errors import InputError
from jaxswarm.robot import bias_forces, inverse_dynamics
from jaxswarm.robot.placements import body_parameters
from jaxswarm.robot.trig import polynomial_sincos
from jaxswarm.simulate import (
    Acting,
    Drive,
    Trajectory,
    accelerations,
    check_step,
    fastest_mode,
    make_plant,
    measured_torque,
    rest,
    simulate,
    stable_substeps,
)


def test_every_law_takes_its_share_of_the_torque():
    """With all laws at once: tau == inverse dynamics + laws at the acceleration that results."""
    robot = two_joint_arm()
    terms = [
        Acting(name, 0, 1 if law.scope == "pair" else None)
        for name, law in REGISTRY.items()
        if isinstance(law, TorqueLaw)
    ]
    plant = make_plant(robot, terms, width=0.05)
    q, dq, tau = jnp.array([0.3, -0.5]), jnp.array([0.4, 0.9]), jnp.array([20.0, -5.0])
    memory = tuple(0.3 * jnp.ones(()) for a in plant.remembering for _ in range(a.law.memories))
    state = rest(plant, q, dq)._replace(q=tuple(q), dq=tuple(dq), memory=memory)
    warm = (jnp.asarray(40.0),) * 2
    drive = Drive(tuple(tau), (0.0, 0.0), warm)
    run = jax.jit(lambda s, d: accelerations(plant, s, d, 7.0, polynomial_sincos)[0])
    ddq = jnp.stack(run(state._replace(motor_q=(), motor_dq=()), drive))
    load = inverse_dynamics(robot, q, dq, ddq)
    static = bias_forces(robot, q, dq)
    spent = 0.0
    for acting in plant.acting:
        other = 1.0 if acting.other else 0.0
        sample = make_sample(
            t=7.0,
            q=q[0],
            dq=dq[0],
            ddq=ddq[0],
            direction=jnp.tanh(dq[0] / 0.05),
            load=load[0],
            static_load=static[0],
            temperature=40.0,
            q_other=other * q[1],
            dq_other=other * dq[1],
            ddq_other=other * ddq[1],
            direction_sum=jnp.tanh((dq[0] + other * dq[1]) / 0.05),
            direction_difference=jnp.tanh((dq[0] - other * dq[1]) / 0.05),
            state=0.3,
        )
        sample = sample._replace(state=remembered(acting.law, sample.state))
        spent += acting.law.torque(acting.values, sample)
    assert abs(load[1] - tau[1]) < 1e-9
    assert abs(load[0] + spent - tau[0]) < 1e-4 * abs(tau[0])
    assert len(terms) >= 12


def test_dry_friction_holds_a_slide_and_lets_it_go():
    term = Acting("coulomb_friction", 0, values={"fc": 10.0})
    plant = make_plant(slide(2.0), [term], width=1e-3)
    force = jnp.concatenate([jnp.full((200, 1), 6.0), jnp.full((200, 1), 14.0)])
    steps = stable_substeps(plant, jnp.zeros(1), 1e-3)
    run = jax.jit(lambda f: simulate(plant, rest(plant, jnp.zeros(1)), f, dt=1e-3, substeps=steps))
    motion = run(force)
    assert motion.dq[199, 0] < 1e-3  # creeps below the width of the smooth sign
    assert abs(motion.ddq[-1, 0] - 2.0) < 1e-3


def test_step_too_long_for_dry_friction_is_refused_and_does_diverge():
    term = Acting("coulomb_friction", 0, values={"fc": 10.0})
    plant = make_plant(slide(2.0), [term], width=1e-3)
    eigenvalue, longest = fastest_mode(plant, jnp.zeros(1))
    assert abs(eigenvalue + 10.0 / 2.0 / 1e-3) < 1e-6
    assert abs(longest - 2.785 / 5000.0) < 1e-5
    with pytest.raises(InputError, match="eigenvalue of -5000"):
        check_step(plant, jnp.zeros(1), 1e-3)
    check_step(plant, jnp.zeros(1), 5e-4)
    push = jnp.full((100, 1), 6.0)
    start = rest(plant, jnp.zeros(1))
    with pytest.raises(InputError, match="steps up to 0.000557 s are stable"):
        simulate(plant, start, push, dt=2e-3)
    long = jax.jit(lambda u: simulate(plant, start, u, dt=2e-3))(push)
    short = simulate(plant, start, push, dt=2e-3, substeps=4)
    assert np.ptp(long.dq[-20:, 0]) > 1e-4 > np.ptp(short.dq[-20:, 0])


def test_flexible_joint_arm_equals_its_textbook_equations():
    """I q1'' + MgL sin q1 + K (q1 - q2) = 0, J q2'' + K (q2 - q1) = u (the plant of the study)."""
    inertia, rotor, weight, stiffness = 1.0, 0.8, 5.0, 1200.0
    robot = two_joint_arm()
    body = body_parameters(0.0, np.zeros(3), np.diag([0.0, 0.0, inertia]))
    body[1:4] = [0.0, -weight / 9.81, 0.0]  # hangs along -y of the joint, gravity along -y at q = 0
    robot = robot.replace(parameters=np.stack([body, np.diag([1.0] * 10)[9]]))
    terms = [
        Acting("joint_elasticity", 0, values={"k": stiffness, "d": 0.0}),
        Acting("rotor_inertia", 0, values={"ia": rotor}),
    ]
    plant = make_plant(robot, terms)
    dt, num = 1e-3, 400
    u = np.sin(2 * np.pi * dt * np.arange(num))
    tau = np.stack([u, 0 * u], 1)
    # The second joint turns freely about a tilted axis: lock it out by an enormous inertia.
    heavy = Acting("rotor_inertia", 1, values={"ia": 1e12})
    plant = make_plant(robot, [*terms, heavy])
    run = jax.jit(lambda f: simulate(plant, rest(plant, jnp.zeros(2)), f, dt=dt, hold="first"))
    motion = run(tau)
    extra = float(robot.parameters[1, 9]) * np.cos(0.4) ** 2  # inertia of the locked second link

    def flow(t, x):
        push = np.interp(t, dt * np.arange(num), u)
        spring = stiffness * (x[1] - x[0])
        link = (spring - weight * np.sin(x[0])) / (inertia + extra)
        return [x[2], x[3], link, (push - spring) / rotor]

    end = solve_ivp(flow, (0, dt * (num - 1)), np.zeros(4), rtol=1e-10, atol=1e-13).y[:, -1]
    assert abs(motion.q_link[-1, 0] - end[0]) < 1e-7
    assert abs(motion.q[-1, 0] - end[1]) < 1e-7
    assert abs(motion.q[-1, 0] - motion.q_link[-1, 0]) > 1e-5


def test_backlash_leaves_the_link_alone_until_the_gap_is_crossed():
    gap, rotor = 0.01, 0.5
    terms = [
        Acting("backlash", 0, values={"gap": gap}),
        Acting("rotor_inertia", 0, values={"ia": rotor}),
    ]
    plant = make_plant(slide(1.5), terms)
    force, dt, num = 2.0, 5e-4, 800
    run = jax.jit(lambda f: simulate(plant, rest(plant, jnp.zeros(1)), f, dt=dt))
    motion = run(jnp.full((num, 1), force))
    free = 0.5 * (force / rotor) * np.asarray(motion.t) ** 2
    inside = free < 0.98 * gap
    np.testing.assert_allclose(motion.q[inside, 0], free[inside], atol=1e-12)
    assert np.abs(motion.q_link[inside]).max() == 0.0
    # Momentum: the force acts on both together, whatever passes between them.
    momentum = rotor * motion.dq[-1, 0] + 1.5 * motion.dq_link[-1, 0]
    assert abs(momentum - force * motion.t[-1]) < 1e-9
    twist = np.asarray(motion.q - motion.q_link)[-200:, 0]
    assert (np.abs(twist) < 1.5 * gap).all()


def test_bristle_friction_equals_a_stiff_solver():
    fc, x0, mass = 4.0, 2e-3, 2.0
    plant = make_plant(slide(mass), [Acting("hysteresis", 0, values={"fc": fc, "x0": x0})])
    dt, num = 1e-3, 600
    u = 7.0 * np.sin(8.0 * dt * np.arange(num))
    run = jax.jit(lambda f: simulate(plant, rest(plant, jnp.zeros(1)), f, dt=dt, hold="first"))
    motion = run(u[:, None])

    def flow(t, x):
        push = np.interp(t, dt * np.arange(num), u)
        return [x[1], (push - fc * x[2]) / mass, (x[1] - abs(x[1]) * x[2]) / x0]

    end = solve_ivp(
        flow, (0, dt * (num - 1)), np.zeros(3), method="LSODA", rtol=1e-9, atol=1e-12, max_step=dt
    ).y[:, -1]
    assert abs(motion.q[-1, 0] - end[0]) < 5e-5 * np.ptp(motion.q)
    assert abs(motion.state.memory[0] - end[2]) < 2e-3


def test_global_effects_change_the_robot():
    robot = two_joint_arm()
    tilted = make_plant(robot, [Acting("base_tilt", values={"gx": 0.5, "gy": -0.2})]).robot
    np.testing.assert_allclose(tilted.gravity[:2], [0.5, -0.2])
    assert abs(np.linalg.norm(tilted.gravity) - 9.81) < 1e-12 and tilted.gravity[2] < 0
    loaded = make_plant(robot, [Acting("payload", values={"m": 3.0, "mcx": 0.6})]).robot
    np.testing.assert_allclose((loaded.parameters - robot.parameters)[1, :2], [3.0, 0.6])


def test_a_load_is_carried_within_its_window_only():
    robot = two_joint_arm()
    load = {"m": 3.0, "mcx": 0.6, "Izz": 0.2}
    heavy = make_plant(robot, [Acting("payload", values=load)])
    times = {"start": 1.0, "end": 2.0}
    plant = make_plant(robot, [Acting("payload_change", values={**load, **times})])
    state = rest(plant, jnp.array([0.3, -0.5]), jnp.array([1.0, 2.0]))
    state = state._replace(q=tuple(state.q), dq=tuple(state.dq), motor_q=(), motor_dq=(), memory=())
    drive = Drive((5.0, 1.0), (0.0, 0.0), (25.0, 25.0))

    def at(plant, t):
        return np.array(accelerations(plant, state, drive, t, polynomial_sincos)[0])

    bare = make_plant(robot)
    for t, same in ((0.9, bare), (1.5, heavy), (2.1, bare)):
        np.testing.assert_allclose(at(plant, t), at(same, t), rtol=1e-9)
    assert np.abs(at(heavy, 1.5) - at(bare, 1.5)).max() > 1.0


def test_gain_and_delay_show_in_the_measured_torque_only():
    terms = [Acting("drive_gain", 0, values={"gain": 1.1})]
    terms += [Acting("time_delay", values={"seconds": 0.002})]
    plant = make_plant(slide(), terms)
    force = jnp.sin(jnp.arange(50.0))[:, None]
    motion = simulate(plant, rest(plant, jnp.zeros(1)), force, dt=1e-3)
    logged = measured_torque(plant, motion)
    np.testing.assert_allclose(logged[2:], 1.1 * force[:-2], atol=1e-12)


def test_sensors_pick_up_what_the_drives_beside_them_supply():
    """The command of a drive with a dead band, and not what that one's own sensor picks up, or its gain."""
    terms = [
        Acting("drive_gain", 1, values={"gain": 2.0}),
        Acting("torque_crosstalk", 0, 1, values={"c": 0.3}),
        Acting("torque_crosstalk", 1, 0, values={"c": -0.1}),
        Acting("torque_dead_band", 1, values={"d": 0.5}),
    ]
    plant = make_plant(two_joint_arm(), terms)
    force = np.sin(0.05 * np.arange(60.0)[:, None] + [0.3, 1.0])
    zero = jnp.zeros((60, 2))
    t = jnp.arange(60) * 1e-3
    motion = Trajectory(t, zero, zero, zero, jnp.asarray(force), zero, zero, rest(plant, zero[0]))
    command = force[:, 1] + 0.5 * np.sign(force[:, 1])
    wanted = np.stack([force[:, 0] + 0.3 * command, 2.0 * (command - 0.1 * force[:, 0])], axis=1)
    np.testing.assert_allclose(measured_torque(plant, motion), wanted, atol=1e-12)


def test_drives_write_down_bent_and_filtered_torques():
    bend = Acting("torque_constant_saturation", 0, values={"c": 0.1})
    band = Acting("torque_dead_band", 0, values={"d": 0.5})
    slow = Acting("torque_lag", values={"tc": 0.02, "seconds": 0.0})
    force = 3.0 * jnp.sin(0.05 * jnp.arange(400.0))[:, None]
    logged = []
    for acting in (bend, band, slow):
        plant = make_plant(slide(), [acting])
        motion = simulate(plant, rest(plant, jnp.zeros(1)), force, dt=1e-3)
        np.testing.assert_allclose(motion.tau, force)
        logged.append(np.asarray(measured_torque(plant, motion)))
    np.testing.assert_allclose(logged[0], force * (1.0 - 0.1 * np.abs(force)), atol=1e-12)
    np.testing.assert_allclose(logged[1], force + 0.5 * np.sign(force), atol=1e-12)
    told = lsim(([1.0], [0.02, 1.0]), np.asarray(force[:, 0]), np.asarray(motion.t))[1]
    np.testing.assert_allclose(logged[2][200:, 0], told[200:], atol=1e-3)


@pytest.mark.parametrize(
    ("terms", "message"),
    [
        ([Acting("joint_elasticity", 0)], "add rotor_inertia"),
        ([Acting("viscous", 0)], "Did you mean"),
        ([Acting("viscous_friction", 5)], "outside 0..1"),
        ([Acting("viscous_friction")], "needs a joint"),
        ([Acting("viscous_friction", 0, values={"d": 1.0})], "has no parameter d: use b"),
        ([Acting("transmission_coupling", 0)], "partner joint"),
        ([Acting("contact", values={"start": 0.0, "end": 1.0})], "pass its torque as external"),
    ],
)
def test_effects_that_cannot_act_are_refused(terms, message):
    with pytest.raises(InputError, match=message):
        make_plant(two_joint_arm(), terms)
