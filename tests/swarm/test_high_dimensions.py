"""Strategies for many dimensions: their rules by hand, and what they are for."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.swarm import Space, lm_ma_es, minimize, open_es, schedules, sep_cma_es, snes
from jaxswarm.swarm.optimizers.cma_distribution import Rates
from jaxswarm.swarm.optimizers.snes import utilities

KEY = jax.random.key(0)
ORDER = jnp.array([3.0, 1.0, 0.0, 2.0, 5.0, 4.0])  # row 2 is the best


def ellipsoid(x, axes):
    return jnp.sum(axes * (x - 0.4) ** 2)


@pytest.mark.parametrize(
    "optimizer, steps, below",
    [
        (sep_cma_es(), 1500, 1e-6),
        (snes(), 3000, 1e-6),
        (lm_ma_es(), 3000, 1e-3),
        (open_es(100), 1000, 1e-1),
    ],
)
def test_a_hundred_dimensions(optimizer, steps, below):
    """Axes from 1 to 100 (value at the start some 500): learned by all but OpenES, whose Adam copes."""
    space = Space.vector(np.full(100, -1.0), np.full(100, 1.0))
    axes = 10.0 ** jnp.linspace(0.0, 2.0, 100)
    result = minimize(ellipsoid, optimizer, space, KEY, axes, num_steps=steps)
    assert float(result.value) < below


def test_separable_variance_by_hand():
    optimizer = sep_cma_es(6, sigma=0.1)
    state = optimizer.init(KEY, 3)._replace(mean=jnp.full(3, 0.5))
    sample = 0.5 + 0.1 * jnp.asarray(np.random.default_rng(0).normal(size=(6, 3)))
    new, _ = optimizer.update(KEY, state._replace(sample=sample, position=sample), ORDER)
    rates = Rates.of(6, 3)
    weights, y = rates.weights[:3], (np.asarray(sample)[[2, 1, 3]] - 0.5) / 0.1
    np.testing.assert_allclose(new.mean, 0.5 + 0.1 * weights @ y, rtol=1e-12)
    c_1, c_mu = rates.c_1 * 5 / 3, min(1 - rates.c_1 * 5 / 3, rates.c_mu * 5 / 3)
    path = np.sqrt(rates.c_c * (2 - rates.c_c) * rates.mass) * weights @ y
    variance = 1 - c_1 - c_mu + c_1 * path**2 + c_mu * weights @ y**2
    # Only the product of sigma and the root of c draws samples.
    ratio = np.asarray(new.variance) / variance
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-12)
    assert float(new.variance.max()) == pytest.approx(1.0)


def test_natural_gradient_by_hand():
    np.testing.assert_allclose(utilities(6).sum(), 0.0, atol=1e-15)
    optimizer = snes(6, sigma=0.1)
    state = optimizer.init(KEY, 2)._replace(mean=jnp.full(2, 0.5))
    z = np.random.default_rng(1).normal(size=(6, 2))
    sample = jnp.asarray(0.5 + 0.1 * z)
    new, _ = optimizer.update(KEY, state._replace(sample=sample, position=sample), ORDER)
    u, ranked = utilities(6), z[[2, 1, 3, 0, 5, 4]]
    np.testing.assert_allclose(new.mean, 0.5 + 0.1 * u @ ranked, rtol=1e-10)
    rate = (3 + np.log(2)) / (5 * np.sqrt(2))
    spread = 0.1 * np.exp(0.5 * rate * u @ (ranked**2 - 1))
    np.testing.assert_allclose(new.spread, spread, rtol=1e-10)


def test_first_step_of_adam_is_the_rate_in_units_of_sigma():
    optimizer = open_es(6, sigma=0.1, learning_rate=0.5)
    state = optimizer.init(KEY, 4)
    state = state._replace(mean=jnp.full(4, 0.5))
    z = state.sample - optimizer.init(KEY, 4).mean
    np.testing.assert_allclose(z[:3], -z[3:], atol=1e-15)  # mirrored
    sample = 0.5 + z
    value = jnp.sum(sample, axis=1)
    new, _ = optimizer.update(KEY, state._replace(sample=sample, position=sample), value)
    down = np.asarray(new.mean) - 0.5
    np.testing.assert_allclose(np.abs(down), 0.05, rtol=1e-4)
    assert down.sum() < 0.0
    with pytest.raises(InputError, match="num_particles=7 is odd"):
        open_es(7)
    assert isinstance(open_es(8).sigma, type(schedules.linear(1.0, 0.0)))


def test_directions_turn_samples_by_the_rule():
    """Second update: one factor is in use, then two; d by the recurrence of the publication."""
    optimizer = lm_ma_es(4, num_directions=2)
    state = optimizer.init(KEY, 40)
    for k in range(2):
        state, _ = optimizer.update(jax.random.key(k), state, jnp.arange(4.0))
        d, directions = np.asarray(state.noise), np.asarray(state.directions)
        for j in range(k + 1):
            a = 1.0 / (1.5**j * 40)
            d = (1 - a) * d + a * np.outer(d @ directions[j], directions[j])
        drawn = np.asarray(state.mean) + float(state.sigma) * d
        np.testing.assert_allclose(state.sample, drawn, rtol=1e-9)


def test_lm_ma_es_learns_a_rotated_direction():
    """One axis a hundred times shorter, along the diagonal, where scales alone do not help."""
    diagonal = jnp.ones(50) / 50**0.5

    def narrow(x, _):
        y = x - 0.4
        return 1e4 * (y @ diagonal) ** 2 + jnp.sum(y**2)

    space = Space.vector(np.full(50, -1.0), np.full(50, 1.0))
    turned, scaled = (
        float(minimize(narrow, optimizer, space, KEY, num_steps=2500).value)
        for optimizer in (lm_ma_es(), sep_cma_es())
    )
    assert turned < 0.1 * scaled
