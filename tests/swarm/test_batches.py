"""Runs in batches, and order by counting: other ways to the same numbers."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.swarm import Space, around, batches, cma_es, minimize_runs, pso
from jaxswarm.swarm.optimizers.counting import FEW, TIED, ascending, order, place

SPACE = Space.vector([-5.0] * 3, [5.0] * 3)
KEYS = jax.random.split(jax.random.key(4), 12)


def sphere(x, center):
    return jnp.sum((x - center) ** 2, axis=1)


@pytest.mark.parametrize("optimizer", [pso(6), cma_es(6)], ids=["pso", "cma_es"])
def test_batches_are_the_same_runs(monkeypatch, optimizer):
    seen = []

    def told(x, center):
        seen.append(x.shape)
        return sphere(x, center)

    options = dict(num_steps=6, start=around(SPACE.lower + 4.0, 0.1))
    whole = minimize_runs(sphere, optimizer, SPACE, KEYS, 1.0, **options)
    size = sum(leaf.nbytes for leaf in jax.tree.leaves(whole.state)) // 12
    monkeypatch.setattr(batches, "CACHED", 5 * size)  # the largest divisor of 12 below is 4
    found = minimize_runs(told, optimizer, SPACE, KEYS, 1.0, **options)
    assert {shape[0] for shape in seen} == {4 * 6}
    assert jax.tree.structure(found) == jax.tree.structure(whole)
    for one, other in zip(jax.tree.leaves(found), jax.tree.leaves(whole), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12)


def test_no_batches_where_runs_belong_together(monkeypatch):
    size = sum(leaf.nbytes for leaf in jax.tree.leaves(pso(6).init(KEYS[0], 3)))
    monkeypatch.setattr(batches, "CACHED", 8 * size)
    assert batches.batch_of(pso(6), 3, None, 12) == 6
    assert batches.batch_of(pso(6), 3, None, 8) == 8, "all fit"
    assert batches.batch_of(pso(6), 3, None, 13) == 13, "only single runs would be left"
    values = []
    minimize_runs(
        sphere, pso(6), SPACE, KEYS, 1.0, num_steps=4, progress_every=2,
        progress=lambda count, best: values.append(best.shape),
    )  # fmt: skip
    jax.effects_barrier()
    assert set(values) == {(12,)}, "progress is told of all runs at once"


@pytest.mark.parametrize("n", [1, 7, FEW, FEW + 1, 1000])
def test_counting_orders_as_a_sort(n):
    draw = np.random.default_rng(n)
    first, second = draw.integers(0, 4, (2, n)).astype(float)
    first[draw.random(n) < 0.2] = np.inf
    np.testing.assert_array_equal(
        order(jnp.array(first), jnp.array(second)), np.lexsort((second, first))
    )
    np.testing.assert_array_equal(order(jnp.array(first)), np.argsort(first, kind="stable"))
    np.testing.assert_array_equal(ascending(jnp.array(first)), np.sort(first))
    at = np.lexsort((second, first))
    np.testing.assert_array_equal(place(jnp.array(first), jnp.array(second))[at], np.arange(n))
    # Numbers that all differ, of both signs and sizes, in both precisions, alone and in runs.
    for dtype in (jnp.float32, jnp.float64):
        apart = jnp.array(draw.normal(size=n) * 10.0 ** draw.integers(-30, 30, n), dtype)
        at = np.argsort(apart, kind="stable")
        np.testing.assert_array_equal(ascending(apart), np.sort(apart))
        both = jax.vmap(place)(jnp.stack([apart, jnp.asarray(first, dtype)]))
        np.testing.assert_array_equal(both[0][at], np.arange(n))
        np.testing.assert_array_equal(both[1][np.argsort(first, kind="stable")], np.arange(n))
    np.testing.assert_array_equal(place(jnp.zeros(n).at[0].set(-0.0)), np.arange(n))


@pytest.mark.parametrize("ties", [2, TIED // 3, TIED])
def test_a_few_rows_that_share_a_place_are_put_apart_among_themselves(ties):
    """In float32 two of a thousand values are often equal, and each time all were sorted by all keys."""
    draw = np.random.default_rng(ties)
    first, second = draw.permutation(1000.0 + np.arange(1000)), draw.integers(0, 2, 1000) + 0.0
    rows = draw.choice(1000, 3 * ties, replace=False)
    first[rows] = first[
        rows[np.arange(3 * ties) // 3]
    ]  # threes of equal numbers, up to 3 TIED rows
    first, second = jnp.asarray(first, jnp.float32), jnp.asarray(second, jnp.float32)
    wanted = np.argsort(np.lexsort((second, first)))
    np.testing.assert_array_equal(place(first, second), wanted)
    both = jax.vmap(place)(jnp.stack([first, second]), jnp.stack([second, first]))
    np.testing.assert_array_equal(both[0], wanted)
    np.testing.assert_array_equal(both[1], np.argsort(np.lexsort((first, second))))
    np.testing.assert_array_equal(place(first), np.argsort(np.argsort(first, kind="stable")))
