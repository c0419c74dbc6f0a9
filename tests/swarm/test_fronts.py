"""Fronts: ranks by definition, hypervolume by inclusion and exclusion, searches on ZDT and DTLZ."""

from itertools import combinations

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.swarm import Space, front, hypervolume, minimize, minimize_runs, mopso, nsga2, pso
from jaxswarm.swarm.pareto import crowding, ranks
from jaxswarm.swarm.random import fold

KEY = jax.random.key(0)


def zdt1(x, _):
    """E. Zitzler, K. Deb, L. Thiele, 2000; the front is f2 = 1 - sqrt(f1), f1 in [0, 1]."""
    g = 1.0 + 9.0 * jnp.mean(x[1:])
    return x[0], g * (1.0 - jnp.sqrt(x[0] / g))


def dtlz2(x, _):
    """K. Deb et al., 2002; the front is the unit sphere's positive octant."""
    g = 1.0 + jnp.sum((x[2:] - 0.5) ** 2)
    a, b = 0.5 * jnp.pi * x[0], 0.5 * jnp.pi * x[1]
    return g * jnp.array([jnp.cos(a) * jnp.cos(b), jnp.cos(a) * jnp.sin(b), jnp.sin(a)])


@pytest.mark.parametrize("objectives", [1, 2, 3, 4])
def test_hypervolume_by_inclusion_and_exclusion(objectives):
    rng = np.random.default_rng(objectives)
    values, reference = rng.uniform(0.0, 1.2, (7, objectives)), np.full(objectives, 1.1)
    room = np.maximum(reference - values, 0.0)
    expected = 0.0
    for size in range(1, 8):
        for some in combinations(range(7), size):
            expected -= (-1) ** size * np.prod(room[list(some)].min(axis=0))
    assert hypervolume(values, reference) == pytest.approx(expected, rel=1e-12)


def test_ranks_by_definition():
    values = np.random.default_rng(0).integers(0, 5, (30, 3)).astype(float)
    left, expected = set(range(30)), np.zeros(30, int)
    for number in range(30):
        beats = lambda a, b: (values[a] <= values[b]).all() and (values[a] < values[b]).any()  # noqa: E731
        on_front = {i for i in left if not any(beats(j, i) for j in left)}
        expected[list(on_front)] = number
        left -= on_front
    np.testing.assert_array_equal(ranks(jnp.asarray(values)), expected)


def test_crowding_by_hand_in_two_fronts():
    values = jnp.array([[0.0, 8.0], [2.0, 6.0], [3.0, 2.0], [8.0, 0.0], [9.0, 9.0]])
    rank = ranks(values)
    assert rank.tolist() == [0, 0, 0, 0, 1]
    expected = [np.inf, 3 / 8 + 6 / 8, 6 / 8 + 6 / 8, np.inf, np.inf]
    np.testing.assert_allclose(crowding(values, rank), expected)


@pytest.mark.parametrize("optimizer", [nsga2(2, 60), mopso(2, 60, size=60)])
def test_zdt1(optimizer):
    space = Space.vector([0.0] * 8, [1.0] * 8)
    found = minimize(zdt1, optimizer, space, KEY, num_steps=150)
    whole = 1.1 * 1.0 - 1.0 + 2.0 / 3.0 + 0.1 * 1.1  # what the true front dominates
    best = front(found, space)
    assert len(best.values) > 30 and best.params.shape == (len(best.values), 8)
    assert 0.97 * whole < hypervolume(best.values, [1.1, 1.1]) < whole
    np.testing.assert_allclose(jax.vmap(lambda x: jnp.stack(zdt1(x, 0)))(best.params), best.values)
    assert bool((found.history[1:] <= found.history[:-1]).all())


@pytest.mark.parametrize("dtype", ["float32", "float64"])
@pytest.mark.parametrize("optimizer", [nsga2(2, 24), mopso(2, 24, size=24)])
def test_a_front_stays_long_after_it_was_found(optimizer, dtype):
    """10,000 updates; what is most crowded leaves a full front, so its worth wavers but does not fall."""

    def step(state, _):
        value = jax.vmap(lambda x: jnp.stack(zdt1(x, 0)))(state.position)
        return optimizer.update(fold(KEY, state.count), state, value)[0], None

    def thousand(state, _):
        state = jax.lax.scan(step, state, length=1000)[0]
        return state, getattr(state, state.FRONT[1])

    begin = optimizer.init(KEY, 3, dtype)
    state, fronts = jax.jit(lambda s: jax.lax.scan(thousand, s, length=10))(begin)
    worth = [hypervolume(values, [1.1, 1.1]) for values in np.asarray(fronts)]
    assert np.isfinite(fronts).all() and min(worth) > 0.95 * max(worth)
    for leaf in jax.tree.leaves(state):
        inexact = jnp.issubdtype(leaf.dtype, jnp.inexact)
        assert not inexact or (leaf.dtype == dtype and np.isfinite(leaf).all())


def test_three_objectives_and_many_runs():
    space, keys = Space.vector([0.0] * 5, [1.0] * 5), jax.random.split(KEY, 2)
    options = dict(num_steps=60, vectorized=False)
    found = minimize_runs(dtlz2, nsga2(3, 60), space, keys, **options)
    best = front(found, space)
    assert found.value.shape == (2,) and len(best.values) > 60
    radius = np.linalg.norm(best.values, axis=1)
    assert np.median(radius) < 1.05 and radius.min() > 1.0 - 1e-9


@pytest.mark.parametrize("optimizer", [nsga2(2, 8), mopso(2, 8)])
def test_values_that_are_not_numbers(optimizer):
    def broken(x, _):
        return jnp.where(x[0] < 0.5, jnp.nan, x[0]), x[1]

    space = Space.vector([0.0] * 2, [1.0] * 2)
    found = minimize(broken, optimizer, space, KEY, num_steps=20)
    best = front(found, space)
    assert np.isfinite(best.values).all() and (best.position[:, 0] >= 0.5).all()
    nothing = minimize(lambda x, _: (jnp.nan, x[0]), optimizer, space, KEY, num_steps=3)
    assert len(front(nothing, space).values) == 0 and not bool(nothing.status.ok)


def test_what_does_not_fit_is_refused():
    space = Space.vector([0.0] * 2, [1.0] * 2)
    with pytest.raises(InputError, match="one row of 3 numbers"):
        minimize(zdt1, nsga2(3, 8), space, KEY, num_steps=1)
    with pytest.raises(InputError, match="holds no front"):
        front(minimize(lambda x, _: x[0], pso(4), space, KEY, num_steps=1), space)
    with pytest.raises(InputError, match="one objective has no front"):
        nsga2(1)
    with pytest.raises(InputError, match=r"give \(m, k\) and \(k,\)"):
        hypervolume([[1.0, 2.0]], [3.0])
