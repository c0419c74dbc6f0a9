"""The loop: counts, histories, stop rules, many runs, compilations, bad objectives."""

import dataclasses
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.swarm import (
    Space,
    any_of,
    collapsed,
    elitist_learning,
    find_optimizer,
    minimize,
    minimize_runs,
    pso,
    stalled,
    target,
)
from jaxswarm.swarm.random import fold
from jaxswarm.swarm.repeating import flat, unflat
from jaxswarm.swarm.standing import Progress

KEY = jax.random.key(0)
KEYS = jax.random.split(KEY, 3)
SPACE = Space.vector([-5.0] * 3, [5.0] * 3)
SWARM = pso(12)


def sphere(x, center):
    return jnp.sum((x - center) ** 2, axis=-1)


def test_finds_the_minimum_and_counts():
    result = minimize(sphere, SWARM, SPACE, KEY, 1.0, num_steps=80)
    np.testing.assert_allclose(result.params, 1.0, atol=1e-2)
    assert int(result.num_steps) == 80 and int(result.num_evaluations) == 80 * 12
    assert result.history.shape == (80,) and bool((jnp.diff(result.history) <= 0).all())
    np.testing.assert_allclose(sphere(SPACE.decode(result.position), 1.0), result.value)
    assert result.check() is result and result.status.message == "all steps done"


def test_evaluations_are_those_of_the_objective():
    seen = []

    def counted(x, _):
        jax.debug.callback(lambda v: seen.append(np.shape(v)[0]), x[:, 0])
        return jnp.sum(x**2, axis=1)

    optimizer = elitist_learning(pso(5))
    stop = stalled(2)
    result = minimize(counted, optimizer, SPACE, KEY, num_steps=40, stop=stop, vectorized=True)
    jax.effects_barrier()
    assert sum(seen) == int(result.num_evaluations) == 6 * int(result.num_steps)


def test_vectorized_is_the_same_search():
    one = minimize(sphere, SWARM, SPACE, KEY, 1.0, num_steps=10)
    many = minimize(sphere, SWARM, SPACE, KEY, 1.0, num_steps=10, vectorized=True)
    np.testing.assert_allclose(one.value, many.value, rtol=1e-6)


def test_runs_equal_single_searches():
    together = minimize_runs(sphere, SWARM, SPACE, KEYS, 1.0, num_steps=10)
    run = partial(minimize, sphere, SWARM, SPACE, args=1.0, num_steps=10, vectorized=True)
    mapped = jax.vmap(lambda key: run(key=key))(KEYS)
    single = [run(key=key) for key in KEYS]
    for i in range(3):
        np.testing.assert_allclose(together.params[i], single[i].params, rtol=1e-9)
        np.testing.assert_allclose(mapped.history[i], single[i].history, rtol=1e-9)
        np.testing.assert_allclose(together.history[i], single[i].history, rtol=1e-9)


def test_runs_with_a_stop_rule_hold_what_is_done():
    options = dict(num_steps=60, stop=any_of(target(0.05), stalled(8)))
    together = minimize_runs(sphere, SWARM, SPACE, KEYS, 1.0, **options)
    for i in range(3):
        single = minimize(sphere, SWARM, SPACE, KEYS[i], 1.0, vectorized=True, **options)
        assert int(together.num_steps[i]) == int(single.num_steps)
        assert together.status.message[i] == single.status.message
        np.testing.assert_allclose(together.value[i], single.value, rtol=1e-9)
        np.testing.assert_allclose(together.history[i], single.history, rtol=1e-9)


def test_target_ends_the_search_at_once():
    result = minimize(sphere, SWARM, SPACE, KEY, 1.0, num_steps=500, stop=target(1e-2))
    steps = int(result.num_steps)
    assert result.status.message == "target value reached" and steps < 500
    assert float(result.history[steps - 1]) <= 1e-2 < float(result.history[steps - 2])
    assert bool((result.history[steps:] == result.value).all())
    assert int(result.state.count) == steps


def test_stop_rules_one_by_one():
    now = Progress(count=5, value=1.0, since=3, diversity=0.1)
    for rule, fires, code in [
        (target(1.0), True, 1),
        (target(0.9), False, 1),
        (stalled(3), True, 2),
        (stalled(4), False, 2),
        (collapsed(0.1), True, 4),
        (collapsed(0.01), False, 4),
        (any_of(target(0.0), stalled(3), collapsed(0.2)), True, 2),
    ]:
        done, reason = rule(jax.tree.map(jnp.asarray, now))
        assert bool(done) is fires and (not fires or int(reason) == code)


def test_stalled_counts_updates_without_improvement():
    flat = minimize(lambda x, _: 0.0 * x[0], SWARM, SPACE, KEY, num_steps=50, stop=stalled(7))
    assert int(flat.num_steps) == 8  # the first update improves on infinity


def test_nan_everywhere_gives_a_status():
    for stop in (None, stalled(5)):
        options = dict(num_steps=20, stop=stop)
        result = minimize(lambda x, _: jnp.nan * x[0], SWARM, SPACE, KEY, **options)
        assert "finite" in result.status.message and not bool(result.status.ok)
        with pytest.raises(RuntimeError, match="no candidate"):
            result.check()


def test_record_keeps_what_is_asked():
    def record(state, info):
        return {"spread": info.diversity, "best": state.best_position}

    result = minimize(sphere, SWARM, SPACE, KEY, 1.0, num_steps=7, record=record)
    assert result.history["best"].shape == (7, 3) and result.history["spread"].shape == (7,)


def test_going_on_is_the_same_search():
    whole = minimize(sphere, SWARM, SPACE, KEY, 1.0, num_steps=20)
    first = minimize(sphere, SWARM, SPACE, KEY, 1.0, num_steps=10)
    second = minimize(sphere, SWARM, SPACE, KEY, 1.0, num_steps=10, state=first.state)
    np.testing.assert_array_equal(whole.state.position, second.state.position)


def test_numbers_do_not_compile_again():
    traces = []

    def counted(x, center):
        traces.append(1)
        return sphere(x, center)

    for inertia, center, upper, patience in [(0.7, 1.0, 5.0, 5), (0.6, 2.0, 6.0, 9)]:
        swarm = dataclasses.replace(SWARM, inertia=inertia)
        space = Space.vector([-5.0] * 3, [upper] * 3)
        stop = any_of(target(1e-9), stalled(patience))
        minimize(counted, swarm, space, KEY, center, num_steps=5, stop=stop)
        if center == 1.0:
            first = len(traces)
    assert len(traces) == first


def test_sweep_over_a_coefficient_and_problems():
    inertia, centers = jnp.array([0.3, 0.7, 1.2]), jnp.array([0.0, 1.0])

    def run(inertia, center):
        swarm = dataclasses.replace(SWARM, inertia=inertia)
        return minimize(sphere, swarm, SPACE, KEY, center, num_steps=30).value

    table = jax.vmap(jax.vmap(run, (None, 0)), (0, None))(inertia, centers)
    assert table.shape == (3, 2)
    np.testing.assert_allclose(table[1, 1], run(0.7, 1.0), rtol=1e-6)
    assert bool((table[2] > table[1]).all())  # an inertia above 1 does not settle


def test_progress_is_called_and_absent_when_off():
    seen = []
    options = dict(progress=lambda count, value: seen.append((int(count), float(value))))
    minimize(sphere, SWARM, SPACE, KEY, 1.0, num_steps=10, progress_every=4, **options)
    jax.effects_barrier()
    assert [count for count, _ in seen] == [4, 8]
    off = jax.make_jaxpr(lambda k: minimize(sphere, SWARM, SPACE, k, 1.0, num_steps=2))(KEY)
    assert "callback" not in str(off)


def test_float32_search_stays_float32():
    space = Space.vector(np.zeros(2, np.float32), np.ones(2, np.float32))
    result = minimize(sphere, SWARM, space, KEY, 0.5, num_steps=5)
    assert {leaf.dtype for leaf in (result.value, result.params, result.state.velocity)} == {
        jnp.dtype("float32")
    }


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda: minimize(lambda x, _: x, SWARM, SPACE, KEY, num_steps=2), "expected a scalar"),
        (
            lambda: minimize(
                lambda x, _: jnp.sum(x**2), SWARM, SPACE, KEY, num_steps=2, vectorized=True
            ),
            r"expected \(12,\): with vectorized=True",
        ),
        (lambda: minimize(sphere, SWARM, SPACE, KEY, 1.0, num_steps=0), "num_steps=0"),
        (lambda: minimize(3, SWARM, SPACE, KEY, num_steps=2), "fn=3 must be a function"),
        (lambda: minimize(sphere, SWARM, SPACE, 7, 1.0, num_steps=2), "key"),
        (lambda: minimize(sphere, SWARM, SPACE, KEY, 1.0, num_steps=2, stop=5), "stop=5 must be"),
        (
            lambda: minimize(sphere, SWARM, SPACE, KEY, 1.0, num_steps=2, state=SWARM.init(KEY, 2)),
            r"shape of .*best_position \(2,\), in this search \(3,\)",
        ),
        (lambda: find_optimizer("gspo"), "is unknown.*gpso"),
    ],
)
def test_bad_calls_are_named(call, message):
    with pytest.raises(InputError, match=message):
        call()


@pytest.mark.parametrize("dims, laid", [(3, (36,)), (16, (12, 16)), (30, (360,)), (50, (12, 50))])
def test_rows_that_fill_the_lanes_of_a_processor_are_carried_as_they_are(dims, laid):
    """Rows of 32 or 64 took half the core-seconds of a flat array; the search is the same by hand."""
    space = Space.vector([-5.0] * dims, [5.0] * dims)
    state = SWARM.init(KEY, dims)
    assert flat(state).position.shape == flat(state).velocity.shape == laid
    back = unflat(flat(state))
    assert back.position.shape == (12, dims) and bool((back.position == state.position).all())
    step = jax.jit(SWARM.update)
    for _ in range(5):
        value = jax.vmap(lambda x: sphere(space.decode(x), 1.0))(state.position)
        state, _ = step(fold(KEY, state.count), state, value)
    result = minimize(sphere, SWARM, space, KEY, 1.0, num_steps=5)
    np.testing.assert_allclose(result.state.position, state.position, rtol=1e-12, atol=1e-12)
