"""Simulated motion against adaptive integration, conservation laws and the closed loop."""

import re

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from arms import slide, two_joint_arm
from scipy.integrate import solve_ivp

from jaxswarm.errors import InputError
from jaxswarm.robot import forward_dynamics, kinetic_energy, potential_energy
from jaxswarm.simulate import (
    PD,
    Acting,
    Cascade,
    ComputedTorque,
    Reference,
    make_plant,
    rest,
    simulate,
    track,
)


def test_energy_is_conserved_without_effects():
    robot = two_joint_arm()
    plant = make_plant(robot)
    start = rest(plant, jnp.array([0.5, -0.3]), jnp.array([1.0, 2.0]))
    motion = jax.jit(lambda s: simulate(plant, s, jnp.zeros((1000, 2)), dt=1e-3))(start)
    energy = jax.vmap(lambda q, dq: kinetic_energy(robot, q, dq) + potential_energy(robot, q))
    levels = energy(motion.q, motion.dq)
    assert np.ptp(levels) < 1e-8 * np.abs(levels[0])
    assert np.ptp(motion.q[:, 0]) > 0.5


@pytest.mark.parametrize("hold", ["zero", "first"])
def test_motion_equals_adaptive_integration(hold):
    robot = two_joint_arm("prismatic")
    terms = [Acting("viscous_friction", j, values={"b": 0.8}) for j in (0, 1)]
    terms += [Acting("joint_spring", 1, values={"k": 30.0, "tau0": 1.0})]
    plant = make_plant(robot, terms)
    dt, num = 5e-3, 60
    tau = np.random.default_rng(0).normal(size=(num, 2)) * 5.0
    motion = jax.jit(lambda u: simulate(plant, rest(plant, jnp.zeros(2)), u, dt=dt, hold=hold))(tau)
    acceleration = jax.jit(lambda q, dq, u: forward_dynamics(robot, q, dq, u))

    def flow(t, x):
        k = min(int(t / dt + 1e-9), num - 1)
        u = tau[k]
        if hold == "first" and k + 1 < num:
            u = u + (t / dt - k) * (tau[k + 1] - u)
        u = u - 0.8 * x[2:] - np.array([0.0, 30.0 * x[1] + 1.0])
        return np.concatenate([x[2:], acceleration(x[:2], x[2:], u)])

    x = np.zeros(4)
    for k in range(num - 1):
        span = (k * dt + 1e-12, (k + 1) * dt - 1e-12)
        x = solve_ivp(flow, span, x, rtol=1e-9, atol=1e-11).y[:, -1]
    np.testing.assert_allclose(motion.q[-1], x[:2], atol=2e-8)
    np.testing.assert_allclose(motion.dq[-1], x[2:], atol=2e-6)


def test_substeps_raise_the_accuracy_with_the_fourth_order():
    plant = make_plant(two_joint_arm())
    start = rest(plant, jnp.array([1.0, 0.4]), jnp.array([2.0, -3.0]))

    def end(substeps):
        run = jax.jit(lambda s: simulate(plant, s, jnp.zeros((11, 2)), dt=0.04, substeps=substeps))
        return run(start).q[-1]

    exact = end(32)
    coarse, fine = (np.abs(end(s) - exact).max() for s in (1, 2))
    assert 10.0 < coarse / fine < 25.0


def test_lanes_equal_single_plants():
    robot = two_joint_arm()
    terms = [Acting("coulomb_friction", 0, values={"fc": jnp.array([0.5, 1.0, 2.0])})]
    plant = make_plant(robot, terms, width=0.1)
    tau = jnp.ones((20, 2, 1)) * jnp.array([3.0, 1.0])[:, None]
    together = simulate(plant, rest(plant, jnp.zeros((2, 3))), tau + jnp.zeros(3), dt=1e-2)
    for k in range(3):
        term = Acting("coulomb_friction", 0, values={"fc": float(terms[0].values["fc"][k])})
        alone = make_plant(robot, [term], width=0.1)
        single = simulate(alone, rest(alone, jnp.zeros(2)), tau[..., 0], dt=1e-2)
        np.testing.assert_allclose(together.q[..., k], single.q, atol=1e-13)


def test_cascade_moves_a_slide_as_its_linear_closed_loop():
    """kp kv gain / (m s^2 + kv gain s + kp kv gain), exact for a piecewise constant force."""
    mass, kp, kv, gain, dt = 2.0, 8.0, 5.0, 3.0, 2e-3
    plant = make_plant(slide(mass))
    num = 400
    reference = Reference(*(jnp.full((num, 1), x) for x in (0.1, 0.0, 0.0, 0.0)))
    controller = Cascade(kp=kp, kv=kv, gain=gain)
    motion = track(plant, rest(plant, jnp.zeros(1)), controller, reference, dt=dt)
    x = np.zeros(2)
    for _ in range(num - 1):
        force = gain * (kp * kv * (0.1 - x[0]) - kv * x[1])
        x = np.array([x[0] + dt * x[1] + 0.5 * dt**2 * force / mass, x[1] + dt * force / mass])
    np.testing.assert_allclose([motion.q[-1, 0], motion.dq[-1, 0]], x, atol=1e-12)
    assert abs(motion.q[-1, 0] - 0.1) < 0.02


def test_slow_controller_holds_its_command_between_calls():
    plant = make_plant(slide())
    reference = Reference(*(jnp.full((12, 1), x) for x in (1.0, 0.0, 0.0, 0.0)))
    controller = PD(kp=4.0, kd=5.0, limit=3.5)
    start = rest(plant, jnp.zeros(1))
    motion = track(plant, start, controller, reference, dt=0.01, control_dt=0.04)
    tau = np.asarray(motion.tau[:, 0]).reshape(3, 4)
    assert (tau == tau[:, :1]).all() and len(np.unique(tau)) == 3
    assert tau[0, 0] == 3.5  # limited


def test_computed_torque_follows_exactly_when_the_model_is_right():
    robot = two_joint_arm()
    plant = make_plant(robot)
    t = np.arange(400)[:, None] * 1e-3
    wave = np.array([0.5, 0.8])
    reference = Reference(
        wave * (1 - np.cos(3 * t)), 3 * wave * np.sin(3 * t), 9 * wave * np.cos(3 * t), 0 * wave * t
    )
    controller = ComputedTorque(robot, kp=400.0, kd=40.0)
    start = rest(plant, jnp.zeros(2))
    run = jax.jit(lambda r: track(plant, start, controller, r, dt=1e-3))
    motion = run(reference)
    assert np.abs(motion.q - reference.q).max() < 2e-3
    assert np.abs(motion.q[:, 0]).max() > 0.3


def test_motion_is_differentiable_in_parameters():
    robot = two_joint_arm()

    @jax.jit
    def end(mass):
        parameters = jnp.asarray(robot.parameters).at[1, 0].set(mass)
        plant = make_plant(robot.replace(parameters=parameters))
        return simulate(plant, rest(plant, jnp.array([0.3, 0.1])), jnp.ones((20, 2)), dt=0.01).q[
            -1, 0
        ]

    slope = jax.jit(jax.grad(end))(1.0)
    assert abs(slope - (end(1.0 + 1e-5) - end(1.0 - 1e-5)) / 2e-5) < 1e-7
    assert abs(slope) > 1e-5


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"control_dt": 0.015}, "no multiple of the step 0.01 s"),
        ({"substeps": 0}, "substeps is 0"),
    ],
)
def test_bad_rates_are_refused(arguments, message):
    plant = make_plant(slide())
    reference = Reference(*[jnp.zeros((3, 1))] * 4)
    start = rest(plant, jnp.zeros(1))
    with pytest.raises(InputError, match=re.escape(message)):
        track(plant, start, PD(1.0, 1.0), reference, dt=0.01, **arguments)
    with pytest.raises(InputError, match="hold is 'cubic'"):
        simulate(plant, start, jnp.zeros((3, 1)), dt=0.01, hold="cubic")


def test_a_plant_without_inertia_is_refused_before_it_moves():
    plant = make_plant(slide(0.0))
    with pytest.raises(InputError, match="its mass matrix is singular; give its links mass"):
        simulate(plant, rest(plant, jnp.zeros(1)), jnp.zeros((3, 1)), dt=0.01)
    controller, reference = PD(1.0, 1.0), Reference(*[jnp.zeros((3, 1))] * 4)
    with pytest.raises(InputError, match="its mass matrix is singular"):
        track(plant, rest(plant, jnp.zeros(1)), controller, reference, dt=0.01)
