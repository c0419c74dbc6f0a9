"""Blocks of lanes give what the plain function gives, whatever the function holds."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.robot import forward_dynamics, in_blocks, inverse_dynamics, rx60
from jaxswarm.robot.placements import body_parameters

BODY = body_parameters(3.0, [0.05, 0.02, 0.1], np.diag([0.03, 0.04, 0.02]))


@pytest.mark.parametrize("count", [1, 5, 8, 19])
def test_blocks_equal_all_lanes_at_once(count):
    """Fewer lanes than a block, whole blocks and a rest, with an argument shared by all."""
    x = jnp.arange(2.0 * count).reshape(2, count)

    def function(lanes, shift):
        return {"a": lanes["x"] * lanes["y"] + shift, "b": jnp.sum(jnp.sin(lanes["x"]), axis=0)}

    lanes = {"x": x, "y": x[0]}
    done = jax.jit(lambda lanes, s: in_blocks(function, lanes, s, size=8))(lanes, 3.0)
    expected = function(lanes, 3.0)
    assert done["a"].shape == (2, count) and done["b"].shape == (count,)
    for name, value in expected.items():
        np.testing.assert_allclose(done[name], value, atol=1e-14)


def test_dynamics_in_blocks_equal_single_samples():
    robot = rx60().replace(parameters=np.tile(BODY, (3, 1)))
    q, dq, ddq = jnp.asarray(np.random.default_rng(0).normal(size=(3, 3, 70)))

    @jax.jit
    def circle(q, dq, ddq):
        """Torques of the motion, then its accelerations from the torques, both in blocks."""
        tau = in_blocks(lambda s: inverse_dynamics(robot, *s), (q, dq, ddq))
        return tau, in_blocks(lambda s: forward_dynamics(robot, *s), (q, dq, tau))

    assert circle.lower(q, dq, ddq).as_text().count("xla_cpu_small_call") >= 2  # compiled as blocks
    tau, back = circle(q, dq, ddq)
    np.testing.assert_allclose(back, ddq, atol=1e-10)
    np.testing.assert_allclose(
        tau[:, 69], inverse_dynamics(robot, q[:, 69], dq[:, 69], ddq[:, 69]), atol=1e-12
    )


def test_derivatives_pass_through_both_ways_and_to_what_is_closed_over():
    x = jnp.linspace(0.1, 1.0, 10)

    def total(x, power):
        def function(y):
            return power * jax.lax.fori_loop(0, 3, lambda i, z: z * y, y)

        return jnp.sum(in_blocks(function, x, size=4))

    for derivative in (jax.grad, jax.jacfwd):
        by_x, by_power = jax.jit(derivative(total, (0, 1)))(x, 2.0)
        np.testing.assert_allclose(by_x, 8 * x**3, rtol=1e-12)
        np.testing.assert_allclose(by_power, jnp.sum(x**4), rtol=1e-12)
    many = jax.jit(jax.vmap(lambda x: total(x, 1.0)))(jnp.stack([x, 2.0 * x]))
    np.testing.assert_allclose(many, jnp.sum(x**4) * jnp.array([1.0, 16.0]), rtol=1e-12)


@pytest.mark.parametrize(
    "function",
    [
        lambda x: jnp.eye(4) @ x,
        lambda x: jnp.linalg.solve(2.0 * jnp.eye(4), x),
        lambda x: jnp.sort(x, axis=0),
        lambda x: x.at[jnp.array([0, 2])].add(1.0),
        lambda x: jax.lax.fori_loop(0, 2, lambda i, y: jnp.ones((4, 4)) @ y, x),
    ],
)
def test_functions_that_call_libraries_are_left_as_they_are(function):
    x = jnp.asarray(np.random.default_rng(1).normal(size=(4, 7)))
    done = jax.jit(lambda x: in_blocks(function, x, size=3))(x)
    np.testing.assert_allclose(done, function(x), atol=1e-14)
