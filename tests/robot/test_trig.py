"""The polynomial sine and cosine against the library in extended precision."""

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.robot.trig import MAX_ANGLE, MAX_ERROR, polynomial_sincos


def test_error_stays_below_the_stated_bound():
    rng = np.random.default_rng(0)
    spans = (1.0, 7.0, 100.0, 1e4, MAX_ANGLE)
    quarters = np.arange(-64, 65) * (np.pi / 2)
    angle = np.concatenate([rng.uniform(-s, s, 100_000) for s in spans] + [quarters])
    sine, cosine = jax.jit(polynomial_sincos)(angle)
    exact = angle.astype(np.longdouble)
    assert np.abs(np.asarray(sine) - np.sin(exact)).max() < MAX_ERROR
    assert np.abs(np.asarray(cosine) - np.cos(exact)).max() < MAX_ERROR


def test_derivatives_are_those_of_sine_and_cosine():
    angle = jnp.linspace(-9.0, 9.0, 101)
    slope = jax.vmap(jax.grad(lambda x: polynomial_sincos(x)[0]))(angle)
    np.testing.assert_allclose(slope, np.cos(angle), atol=1e-13)
    slope = jax.vmap(jax.grad(lambda x: polynomial_sincos(x)[1]))(angle)
    np.testing.assert_allclose(slope, -np.sin(angle), atol=1e-13)


def test_infinite_angles_give_nan_and_single_precision_stays_single():
    assert np.isnan(polynomial_sincos(jnp.asarray(np.inf))[0])
    assert polynomial_sincos(jnp.asarray(1.0, jnp.float32))[0].dtype == jnp.float32
