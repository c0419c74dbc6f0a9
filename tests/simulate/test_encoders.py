"""Encoders that say something else than the joint's position: the motion they say and the one that is."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from arms import two_joint_arm

from jaxswarm.effects import get_law
from jaxswarm.effects.misreading import excess_of_said
from jaxswarm.robot import inverse_dynamics
from jaxswarm.simulate import PD, Acting, Reference, make_plant, rest, simulate, track

DT = 1e-3
WAVES = {"s1": 0.03, "c1": -0.02, "s2": 0.01, "c2": 0.005}


def eccentric(q):
    one, two = 0.03 * np.sin(q[:, 1]) - 0.02 * np.cos(q[:, 1]), 2.0 * q[:, 1]
    return one + 0.01 * np.sin(two) + 0.005 * np.cos(two)


CASES = {
    "offset": ("encoder_offset", None, {"dq0": 0.2}, lambda q: 0.2 + 0.0 * q[:, 1]),
    "eccentric": ("encoder_eccentricity", None, WAVES, eccentric),
    "coupled": ("gear_coupling_error", 0, {"c": 0.1}, lambda q: -0.1 * q[:, 0]),
}


@pytest.mark.parametrize("case", CASES)
def test_links_move_by_what_the_encoders_do_not_say(case):
    effect, other, values, excess = CASES[case]
    robot = two_joint_arm()
    plant = make_plant(robot, [Acting(effect, 1, other, values)])
    begin, speed = jnp.array([0.3, -0.5]), jnp.array([1.0, 2.0])
    start = rest(plant, begin, speed)
    torque = jnp.array([[4.0, 1.0]]) * jnp.sin(0.01 * jnp.arange(250.0))[:, None]
    motion = jax.jit(lambda u: simulate(plant, start, u, dt=DT, hold="first"))(torque)
    q, dq, ddq, link = (np.asarray(getattr(motion, n)) for n in ("q", "dq", "ddq", "q_link"))
    # It starts where the encoders say it does, and they say too much by the law all along.
    np.testing.assert_allclose(q[0], begin, atol=1e-6)
    np.testing.assert_allclose(dq[0], speed, atol=1e-6)
    np.testing.assert_allclose(q[:, 0], link[:, 0])
    at = np.stack([q[:, 0], link[:, 1]], axis=1)
    np.testing.assert_allclose(q[:, 1] - link[:, 1], excess(at), atol=1e-6)
    # Velocity and acceleration are those of what is said.
    np.testing.assert_allclose(np.gradient(q, DT, axis=0)[5:-5], dq[5:-5], atol=5e-4)
    np.testing.assert_allclose(np.gradient(dq, DT, axis=0)[5:-5], ddq[5:-5], atol=1e-2)
    # The torque is that of the links' motion.
    v = np.asarray(motion.dq_link)
    a = np.gradient(v, DT, axis=0)
    spent = jax.vmap(lambda *x: inverse_dynamics(robot, *x))(link, v, a)
    np.testing.assert_allclose(spent[5:-5], torque[5:-5], atol=1e-2)
    apart = jax.vmap(lambda *x: inverse_dynamics(robot, *x))(q, dq, ddq) - torque
    assert np.abs(apart).max() > 0.1


def test_a_controller_follows_what_the_encoder_says():
    plant = make_plant(two_joint_arm(), [Acting("encoder_offset", 1, values={"dq0": 0.2})])
    wanted = jnp.tile(jnp.array([0.2, 0.4]), (1500, 1))
    hold = Reference(wanted, 0.0 * wanted, 0.0 * wanted, 0.0 * wanted)
    start = rest(plant, wanted[0])
    motion = jax.jit(
        lambda s: track(plant, s, PD(jnp.full(2, 3e2), jnp.full(2, 1e1)), hold, dt=DT)
    )(start)
    np.testing.assert_allclose(motion.q[-1], wanted[-1], atol=0.05)
    np.testing.assert_allclose(motion.q_link[-1, 1], motion.q[-1, 1] - 0.2, atol=1e-7)


def test_rounds_of_substitution_do_not_make_the_program_longer():
    """Eight in a row, differentiated by time twice and by four parameters, took 3.3 s to compile."""
    law, x = get_law("encoder_eccentricity"), jnp.linspace(-1.0, 1.0, 5)
    program = str(jax.make_jaxpr(lambda said: excess_of_said(law, WAVES, said, said))(x))
    once = str(jax.make_jaxpr(lambda said: law.excess(WAVES, said, said))(x))
    assert program.count(" = sin ") == 2 * once.count(" = sin ") > 0
