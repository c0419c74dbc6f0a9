"""The reference step by hand, the parts one by one, and schedules that count from zero."""

import dataclasses
import math
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import optax
import pytest

from jaxswarm.errors import InputError
from jaxswarm.swarm import (
    OPTIMIZERS,
    Space,
    absorb,
    bounce,
    canonical,
    clip,
    global_best,
    gpso,
    minimize_runs,
    paired,
    periodic,
    pso,
    random_informants,
    reflect,
    resample,
    ring,
    schedules,
    spso2011,
    von_neumann,
)
from jaxswarm.swarm import random as random_module
from jaxswarm.swarm.optimizers.rules import Swarm
from jaxswarm.swarm.random import Random

KEY = jax.random.key(0)


@pytest.fixture
def half_source(monkeypatch):
    """A source of random bits in which every uniform number is 1/2."""

    def half(key, tag, shape, num):
        return [jnp.zeros(shape, jnp.uint32)] * num  # the middle of the signed range (float64)

    monkeypatch.setitem(random_module.SOURCES, "half", half)
    return "half"


def test_a_swarm_starts_at_rest_or_half_the_way_to_another_point():
    assert not pso(20).init(KEY, 3).velocity.any()
    state = pso(2000, initial_velocity=0.5).init(KEY, 3)
    ahead = np.asarray(state.position + 2.0 * state.velocity)  # the other point: uniform too
    assert ahead.min() >= 0.0 and ahead.max() <= 1.0
    np.testing.assert_allclose(ahead.mean(axis=0), 0.5, atol=0.03)
    for factory in (gpso, spso2011):
        assert factory().init(KEY, 3).velocity.any()


def test_reference_step_by_hand(half_source):
    """Three particles in two dimensions, r1 = r2 = 1/2, w = 1/2, c1 = c2 = 1, nobody meets a wall.

    i  x            v            p before     f(p)  f(x)   p after      x' = x + v'
    0  (0.2, 0.4)   (0.1, 0.0)   (0.2, 0.4)   9     2      (0.2, 0.4)   leader: p = g = x
       v' = 0.05, 0.0                                                    (0.25, 0.4)
    1  (0.6, 0.8)   (0.0, -0.2)  (0.5, 0.5)   3     4      (0.5, 0.5)
       v' = 0.0 + 0.5(-0.1) + 0.5(-0.4), -0.1 + 0.5(-0.3) + 0.5(-0.4)    (0.35, 0.35)
    2  (0.4, 0.4)   (0.2, 0.2)   (0.8, 0.6)   5     nan    (0.8, 0.6)
       v' = 0.1 + 0.5(0.4) + 0.5(-0.2), 0.1 + 0.5(0.2) + 0.5(0.0)        (0.6, 0.6)
    """
    choice = dict(inertia=0.5, cognitive=1.0, social=1.0, velocity_limit=math.inf)
    optimizer = pso(3, **choice, random=half_source)
    state = optimizer.init(KEY, 2)._replace(
        position=jnp.array([[0.2, 0.4], [0.6, 0.8], [0.4, 0.4]]),
        velocity=jnp.array([[0.1, 0.0], [0.0, -0.2], [0.2, 0.2]]),
        memory_position=jnp.array([[0.2, 0.4], [0.5, 0.5], [0.8, 0.6]]),
        memory_value=jnp.array([9.0, 3.0, 5.0]),
        best_position=jnp.array([0.5, 0.5]),
        best_value=jnp.array(3.0),
    )
    new, info = optimizer.update(KEY, state, jnp.array([2.0, 4.0, jnp.nan]))
    np.testing.assert_allclose(new.position, [[0.25, 0.4], [0.35, 0.35], [0.6, 0.6]], atol=1e-8)
    np.testing.assert_allclose(new.velocity, [[0.05, 0.0], [-0.25, -0.45], [0.2, 0.2]], atol=1e-8)
    np.testing.assert_array_equal(new.memory_value, [2.0, 3.0, 5.0])
    np.testing.assert_array_equal(new.memory_position[0], [0.2, 0.4])
    np.testing.assert_array_equal(new.best_position, [0.2, 0.4])
    assert float(info.value_best) == 2.0 and float(info.value_mean) == 3.0 and bool(info.improved)


def test_velocity_limit_and_schedules_count_from_zero():
    seen = []

    def schedule(count):
        jax.debug.callback(lambda c: seen.append(int(c)), count)
        return 0.5

    optimizer = pso(4, inertia=schedule, velocity_limit=0.05)
    state = optimizer.init(KEY, 3)
    assert float(jnp.abs(state.velocity).max()) <= 0.05
    for k in range(3):
        state, _ = optimizer.update(jax.random.key(k), state, jnp.sum(state.position, axis=1))
        assert float(jnp.abs(state.velocity).max()) <= 0.05
    jax.effects_barrier()
    assert seen == [0, 1, 2]


def test_optax_and_own_schedules_agree():
    own = gpso(4, 10)
    theirs = dataclasses.replace(
        own, inertia=pso(4, inertia=optax.linear_schedule(0.9, 0.4, 10)).inertia
    )
    state = own.init(KEY, 3)
    for k in range(12):
        value = jnp.sum(state.position, axis=1)
        (a, info), (b, info_b) = (o.update(jax.random.key(k), state, value) for o in (own, theirs))
        expected = 0.9 - 0.5 * min(k, 10) / 10
        assert float(info.hyper["inertia"]) == pytest.approx(expected, rel=1e-6)
        assert float(info_b.hyper["inertia"]) == pytest.approx(expected, rel=1e-6)
        state = a


def test_schedule_shapes():
    assert float(schedules.cosine(1.0, 0.0, 10)(10)) == pytest.approx(0.0)
    assert float(schedules.exponential(1.0, 0.01, 10)(20)) == pytest.approx(0.01)
    assert float(schedules.linear(0.9, 0.4, 10)(0)) == pytest.approx(0.9)


@pytest.mark.parametrize("boundary", [clip, absorb, bounce, reflect, periodic, resample])
def test_boundaries_keep_inside_and_leave_the_inside_alone(boundary):
    position = jnp.linspace(-3.0, 4.0, 71).reshape(71, 1)
    velocity = jnp.linspace(-1.0, 1.0, 71).reshape(71, 1)
    new, turned = boundary()(Random(KEY), position, velocity)
    assert bool(((new >= 0.0) & (new <= 1.0)).all())
    inside = (position >= 0.0) & (position <= 1.0)
    np.testing.assert_array_equal(new[inside], position[inside])
    np.testing.assert_array_equal(turned[inside], velocity[inside])


def test_boundaries_by_hand():
    x, v = jnp.array([[1.2, -0.3]]), jnp.array([[0.4, -0.5]])
    for boundary, position, velocity in [
        (clip(), [[1.0, 0.0]], [[0.4, -0.5]]),
        (absorb(), [[1.0, 0.0]], [[0.0, 0.0]]),
        (bounce(0.5), [[1.0, 0.0]], [[-0.2, 0.25]]),
        (reflect(0.5), [[0.8, 0.3]], [[-0.2, 0.25]]),
        (periodic(), [[0.2, 0.7]], [[0.4, -0.5]]),
    ]:
        new, turned = boundary(Random(KEY), x, v)
        np.testing.assert_allclose(new, position, atol=1e-12)
        np.testing.assert_allclose(turned, velocity, atol=1e-12)
    new, turned = resample()(Random(KEY), x, v)
    assert not np.allclose(new, x) and not turned.any()


def test_topologies_by_hand():
    memory = jnp.arange(6.0)[:, None]
    value = jnp.array([3.0, 1.0, 4.0, 0.0, 5.0, 2.0])
    random = Random(KEY)
    expected = {
        global_best(): [3, 3, 3, 3, 3, 3],
        ring(1): [1, 1, 3, 3, 3, 5],
        ring(2): [1, 3, 3, 3, 3, 3],
        von_neumann(2): [3, 1, 1, 3, 3, 3],  # grid 0 1 2 / 3 4 5, both directions wrap
    }
    for topology, leaders in expected.items():
        np.testing.assert_array_equal(topology(random, memory, value)[:, 0], leaders)


def test_von_neumann_by_definition():
    rows, columns = 3, 4
    value = jnp.asarray(np.random.default_rng(0).permutation(12).astype(float))
    got = von_neumann()(Random(KEY), jnp.arange(12.0)[:, None], value)[:, 0]
    for i in range(12):
        r, c = divmod(i, columns)
        steps = [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)]
        near = [(r + a) % rows * columns + (c + b) % columns for a, b in steps]
        assert int(got[i]) == min(near, key=lambda j: float(value[j]))


def test_random_informants_listen_to_three_and_themselves():
    n = 30
    value = jnp.arange(float(n))
    memory = value[:, None]
    draw = jax.vmap(lambda k: random_informants(3)(Random(k), memory, value)[:, 0])
    leaders = np.asarray(draw(jax.random.split(KEY, 2000)))
    assert (leaders <= np.arange(n)).all()  # nobody follows one worse than itself
    # Particle j is informed by the best, 0, with probability 1 - (1 - 1/n)^3.
    share = (leaders[:, 5] == 0).mean()
    assert share == pytest.approx(1 - (1 - 1 / n) ** 3, abs=0.02)


def test_graph_changes_only_after_a_step_without_improvement():
    optimizer = spso2011(6)
    state = optimizer.init(KEY, 2)
    better, _ = optimizer.update(jax.random.key(1), state, jnp.arange(6.0))
    np.testing.assert_array_equal(better.graph, state.graph)
    worse, _ = optimizer.update(jax.random.key(2), better, jnp.arange(6.0) + 1.0)
    assert not np.array_equal(worse.graph, better.graph)


def test_spherical_rule_does_not_see_axes():
    """Rotating positions, memories and attractors rotates mean and covariance of the next step."""
    from jaxswarm.swarm import spherical
    from jaxswarm.swarm.optimizers.rules import Swarm

    p, g = jnp.array([0.3, 0.0]), jnp.array([0.3, 0.6])
    zero, one = jnp.zeros((1, 2)), jnp.ones(1)

    def moves(rotation):
        swarm = Swarm(zero, zero, (rotation @ p)[None], (rotation @ g)[None], one, one > 0, one)
        hyper = {"inertia": 0.7, "cognitive": 1.2, "social": 1.2}
        keys = jax.random.split(KEY, 20000)
        return jax.vmap(lambda k: spherical()(Random(k), swarm, hyper)[0])(keys)

    turn = jnp.array([[0.0, -1.0], [1.0, 0.0]])
    straight, turned = moves(jnp.eye(2)), moves(turn)
    np.testing.assert_allclose(turn @ straight.mean(0), turned.mean(0), atol=5e-3)
    np.testing.assert_allclose(turn @ jnp.cov(straight.T) @ turn.T, jnp.cov(turned.T), atol=5e-3)
    center = 1.2 * (p + g) / 3
    radius = jnp.linalg.norm(straight - center, axis=1)
    assert float(radius.max()) <= float(jnp.linalg.norm(center)) * (1 + 1e-9)


def test_a_swarm_has_as_many_particles_as_it_needs():
    for dims, num in (2, 20), (5, 20), (15, 30), (20, 40), (300, 40):
        assert pso().init(KEY, dims).position.shape == (num, dims)
        assert pso(12).init(KEY, dims).position.shape == (12, dims)


def test_a_short_run_reaches_a_lowest_value_on_the_walls():
    """100 evaluations a dimension down a slope: the corner is met, not only neared."""
    dims, slope = 5, jnp.logspace(0.0, 1.0, 5)
    space, optimizer = Space.vector([-5.0] * dims, [5.0] * dims), pso()
    steps = 100 * dims // optimizer.init(KEY, dims).position.shape[0]
    keys = jax.random.split(KEY, 40)
    runs = minimize_runs(
        lambda x, _: jnp.sum((x + 5.0) * slope, axis=1), optimizer, space, keys, num_steps=steps
    )
    assert (np.asarray(runs.value) == 0.0).mean() >= 0.9


def test_neighbors_on_a_grid_collapse_less_often_than_followers_of_one():
    """Down a linear slope in twenty dimensions."""
    slope = 10.0 ** jnp.linspace(0.0, 1.0, 20)
    space, keys = Space.vector([-5.0] * 20, [5.0] * 20), jax.random.split(KEY, 40)
    down = lambda x, _: (x + 5.0) @ slope  # noqa: E731
    arrived = [
        (minimize_runs(down, swarm, space, keys, num_steps=500).value < 1e-8).mean()
        for swarm in (pso(renew=False), pso(topology=global_best(), renew=False))
    ]
    assert arrived[0] >= 0.85 > arrived[1]


@pytest.mark.parametrize(
    "name, limit, wall",
    [
        ("spso", math.inf, absorb()),
        ("spso2011", math.inf, bounce(0.5)),
        *((name, 0.2, reflect(0.5)) for name in ("gpso", "sepso", "clpso", "aelspso")),
    ],
)
def test_published_swarms_keep_their_limit_and_walls(name, limit, wall):
    swarm = OPTIMIZERS[name].factory()
    swarm = getattr(swarm, "inner", swarm)
    assert swarm.velocity_limit == limit and swarm.boundary == wall
    assert swarm.topology == (random_informants(3) if name == "spso2011" else global_best())


@pytest.mark.parametrize(
    "build, message",
    [
        (lambda: pso(1), "num_particles=1 is too small"),
        (lambda: pso(2.5), "num_particles=2.5 must be a whole number"),
        (lambda: pso(inertia="big"), "inertia='big' is neither"),
        (lambda: pso(inertia=[0.1, 0.2]), r"inertia has shape \(2,\), one number is needed"),
        (lambda: pso(social=lambda k: jnp.ones(3)), r"social has shape \(3,\)"),
        (lambda: pso(velocity_limit=-1.0), "velocity_limit=-1.0 must lie in"),
        (lambda: gpso(10, 0), "num_steps=0 must lie in"),
        (lambda: pso(initial_velocity=2.0), "initial_velocity=2.0 must lie in"),
        (lambda: reflect(2.0), "damping=2.0"),
        (lambda: ring(0), "reach=0"),
        (lambda: von_neumann(5)(Random(KEY), jnp.ones((12, 1)), jnp.ones(12)), "rows=5 does not"),
    ],
)
def test_bad_arguments_are_named(build, message):
    with pytest.raises(InputError, match=message):
        build()


def test_random_numbers_of_a_step_are_computed_once():
    """Without ``once`` XLA hashes for the velocity and again for the position; its branch remains."""
    from jaxswarm.swarm.optimizers.base import once

    def moved(x):
        step = once(lambda: jnp.sin(x))
        return step, x + step

    x = jnp.linspace(0.0, 1.0, 8)
    np.testing.assert_allclose(jax.jit(moved)(x)[1], x + jnp.sin(x), rtol=1e-15)
    np.testing.assert_allclose(jax.vmap(moved)(x[:, None])[1][:, 0], x + jnp.sin(x), rtol=1e-15)
    if jax.default_backend() == "cpu":
        assert "conditional" in jax.jit(moved).lower(x).compile().as_text()


def rastrigin(x, _):
    """Another of many valleys is where a swarm of a few particles rests."""
    x = x - 1.234
    return (10.0 * (1.0 - jnp.cos(2.0 * jnp.pi * x)) + x**2).sum(axis=-1) + 7.0


def test_a_swarm_at_rest_begins_anew():
    """Of 20 swarms that rest 14 end in another valley."""
    space, keys = Space.vector([-5.0] * 2, [5.0] * 2), jax.random.split(KEY, 20)
    found = minimize_runs(rastrigin, pso(8), space, keys, num_steps=4000)
    np.testing.assert_allclose(found.value, 7.0, atol=1e-8)
    rests = minimize_runs(rastrigin, pso(8, renew=False), space, keys, num_steps=4000)
    assert int((rests.value > 7.5).sum()) > 5


def test_what_a_swarm_that_begins_anew_keeps():
    """The best candidate and the count; the particles set off as those of a first swarm do."""
    optimizer = pso(6, initial_velocity=0.5)
    state, _ = optimizer.update(KEY, optimizer.init(KEY, 2), jnp.arange(6.0))
    worse = jnp.full(6, 9.0)
    for k in range(49):
        state, _ = optimizer.update(jax.random.key(k), state, worse)
    assert int(state.idle) == 49 and bool(jnp.isfinite(state.memory_value).all())
    best = state.best_position
    state, info = optimizer.update(KEY, state, worse)
    assert int(state.idle) == 0 and bool(jnp.isinf(state.memory_value).all())
    assert int(state.count) == 51 and float(state.best_value) == float(info.value_best) == 0.0
    np.testing.assert_array_equal(state.best_position, best)
    assert not info.improved and state.velocity.any()
    state, info = optimizer.update(KEY, state, worse)
    assert float(info.value_best) == 0.0 and float(state.memory_value.min()) == 9.0
    np.testing.assert_array_equal(state.best_position, best)


@pytest.mark.parametrize("name", ["spso", "gpso", "sepso", "aelspso", "spso2011", "clpso"])
def test_swarms_as_published_rest(name):
    optimizer = OPTIMIZERS[name].factory()
    assert not getattr(optimizer, "inner", optimizer).renew


def test_runs_side_by_side_begin_anew_each_for_itself():
    """One lane at rest, one that is not: each as alone, whatever the other does."""
    optimizer = pso(6)
    state = optimizer.init(KEY, 2)
    state, _ = optimizer.update(KEY, state, jnp.arange(6.0))
    two = jax.tree.map(lambda leaf: jnp.stack([leaf, leaf]), state)
    two = two._replace(idle=jnp.array([49, 3], jnp.int32))
    keys, value = jax.random.split(KEY, 2), jnp.full((2, 6), 9.0)
    together, _ = jax.vmap(optimizer.update)(keys, two, value)
    assert together.idle.tolist() == [0, 4]
    for run in range(2):
        own = jax.tree.map(partial(jnp.take, indices=run, axis=0), two)
        alone, _ = optimizer.update(keys[run], own, value[run])
        for a, b in zip(jax.tree.leaves(alone), jax.tree.leaves(together), strict=True):
            np.testing.assert_allclose(a, b[run], rtol=1e-6)


@pytest.mark.parametrize(("dims", "pairs"), [(2, 3), (6, 3), (7, 0)])
def test_in_few_dimensions_three_of_four_particles_draw_one_pair_for_all_coordinates(dims, pairs):
    """Both pulls are along the diagonal: whoever draws one pair stays on it."""
    ones, zeros = jnp.ones((8, dims)), jnp.zeros((8, dims))
    seen = Swarm(zeros, zeros, ones, 2.0 * ones, jnp.zeros(8), jnp.zeros(8, bool), jnp.zeros(8))
    hyper = {"inertia": 0.5, "cognitive": 1.0, "social": 1.0}
    moved = np.asarray(paired()(Random(KEY, "hash"), seen, hyper))
    on_diagonal = np.ptp(moved, axis=1) == 0.0
    assert on_diagonal.sum() == 2 * pairs
    assert len(np.unique(moved[:, 0])) == 8 and (moved > 0.0).all() and (moved < 3.0).all()


def test_a_swarm_walks_down_a_turned_valley():
    """A thousand times as steep across as along, and no axis along it: by pairs a coordinate none arrives."""
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    steep = jnp.asarray(turn.T @ np.diag([1.0, 1e3, 1e3]) @ turn)
    space, keys = Space.vector([-5.0] * 3, [5.0] * 3), jax.random.split(KEY, 20)

    def valley(x, _):
        return jnp.einsum("...i,ij,...j->...", x - 1.0, steep, x - 1.0)

    left = [
        float(jnp.median(minimize_runs(valley, s, space, keys, num_steps=150).value))
        for s in (pso(), pso(rule=canonical()))
    ]
    assert left[0] < 0.1 * left[1]
