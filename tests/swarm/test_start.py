"""A search begins where it is told, whatever the optimizer and however it is wrapped."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.swarm import (
    OPTIMIZERS,
    Bound,
    Space,
    around,
    cma_es,
    de,
    elitist_learning,
    freeze,
    islands,
    minimize,
    minimize_runs,
    pso,
    restart,
)
from jaxswarm.swarm.search import start_for
from jaxswarm.swarm.start import begun

KEY = jax.random.key(1)
SPACE = Space(a=Bound(1e-3, 1e3, "log"), b=Bound([-1.0, -2.0], [3.0, 2.0]))
POINT = {"a": 10.0, "b": jnp.array([2.5, -1.5])}
WRAPPED = {
    "restart": lambda inner: restart(inner),
    "islands": lambda inner: islands(inner, 2),
    "elitist": lambda inner: elitist_learning(inner),
    "nested": lambda inner: restart(elitist_learning(islands(inner, 2))),
    "frozen": lambda inner: freeze(inner, [False, True, False], [0.0, 0.875, 0.0]),
}


def first_candidates(optimizer, start, key=KEY):
    return begun(optimizer, key, SPACE, start_for(SPACE, start)).position


@pytest.mark.parametrize(
    "name, wrap",
    [(name, None) for name in OPTIMIZERS]
    + [(name, wrap) for name in ("pso", "de", "cma_es") for wrap in WRAPPED],
)
def test_the_point_is_among_the_first_candidates(name, wrap):
    optimizer = OPTIMIZERS[name].factory(8)
    optimizer = WRAPPED[wrap](optimizer) if wrap else optimizer
    wanted = SPACE.encode(POINT)
    position = jax.jit(lambda k: first_candidates(optimizer, POINT, k))(KEY)
    assert float(jnp.abs(position - wanted).max(axis=1).min()) < 1e-12
    assert bool(((position >= 0.0) & (position <= 1.0)).all())


def test_a_population_and_a_spread():
    points = {"a": jnp.array([1.0, 10.0, 100.0]), "b": jnp.array([[0.0, 0.0]] * 3)}
    wanted = jax.vmap(SPACE.encode)(points)
    position = first_candidates(pso(8), points)
    np.testing.assert_allclose(position[:3], wanted)
    drawn = pso(8).init(KEY, 3).position
    np.testing.assert_array_equal(position[3:], drawn[3:])
    near = first_candidates(de(9), around(points, 0.01))
    np.testing.assert_allclose(near[:3], wanted)
    assert 0.0 < float(jnp.abs(near - jnp.tile(wanted, (3, 1))).max()) < 0.06


def test_the_distribution_of_cma_begins_at_the_point():
    wanted = SPACE.encode(POINT)
    for optimizer in (cma_es(400), restart(cma_es(400))):
        position = first_candidates(optimizer, around(POINT, 0.01))
        np.testing.assert_allclose(position.mean(axis=0), wanted, atol=2e-3)
        np.testing.assert_allclose(position.std(axis=0), 0.01, rtol=0.2)
    wide = first_candidates(cma_es(400, sigma=0.05), POINT)
    np.testing.assert_allclose(wide.std(axis=0), 0.05, rtol=0.2)


def test_the_search_uses_it():
    def value(params, _):
        return jnp.sum((SPACE.encode(params) - SPACE.encode(POINT)) ** 2)

    options = dict(num_steps=1, start=POINT)
    assert float(minimize(value, pso(6), SPACE, KEY, **options).value) < 1e-12
    keys = jax.random.split(KEY, 3)
    runs = minimize_runs(value, pso(6), SPACE, keys, vectorized=False, **options)
    assert bool((runs.value < 1e-12).all())
    assert not np.array_equal(runs.state.position[0], runs.state.position[1])


@pytest.mark.parametrize(
    "start, message",
    [
        ({"a": 2e3, "b": POINT["b"]}, "a of point 0 is not within its bounds 0.001 and 1000.0"),
        ({"a": 1.0}, r"\['b'\] missing"),
        ({"a": jnp.ones(9), "b": jnp.zeros((9, 2))}, "holds 9 points, the optimizer has 8"),
    ],
)
def test_a_start_that_does_not_fit_is_refused(start, message):
    with pytest.raises(InputError, match=message):
        first_candidates(pso(8), start)


def test_a_search_that_goes_on_has_no_start():
    state = pso(8).init(KEY, 3)
    with pytest.raises(InputError, match="both given"):
        minimize(lambda p, _: p["a"], pso(8), SPACE, KEY, num_steps=1, state=state, start=POINT)
