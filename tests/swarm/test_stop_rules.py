"""Rules that look back, clocks, and what many runs tell on their way."""

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.swarm import (
    Driver,
    Space,
    any_of,
    cma_es,
    islands,
    minimize,
    minimize_runs,
    minimize_sharded,
    pso,
    search_ended,
    stalled,
    target,
    time_limit,
)
from jaxswarm.swarm.standing import Progress
from jaxswarm.swarm.stopping import ask, begin, renewed

KEY = jax.random.key(0)
SPACE = Space.vector([-5.0] * 2, [5.0] * 2)


def sphere(x, center):
    return jnp.sum((x - center) ** 2, axis=-1)


def fires_at(rule, values):
    """Number of the update at which a rule fires, fed with best values; None if it does not."""
    memory, since, best = begin(rule), 0, np.inf
    for count, value in enumerate(values, 1):
        since, best = (0, value) if value < best else (since + 1, best)
        done, _, memory = ask(
            rule, Progress(jnp.int32(count), jnp.asarray(best), since, 1.0), memory
        )
        if done:
            return count
    return None


def test_small_falls_do_not_count_but_add_up():
    slow = [10.0 - 0.1 * k for k in range(40)]
    assert fires_at(stalled(3), slow) is None
    assert fires_at(stalled(3, tolerance=0.5), slow) == 4
    assert fires_at(stalled(8, tolerance=0.5), slow) is None  # 0.6 in six updates
    assert fires_at(stalled(8, relative=0.1), slow) == 9
    assert fires_at(stalled(3, tolerance=0.5), [np.inf, np.inf, 5.0, 4.0, 3.9, 3.8, 3.7]) == 7


def test_the_first_of_several_rules_gives_the_status():
    rule = any_of(target(-1.0), stalled(3, tolerance=1.0))
    result = minimize(sphere, pso(8), SPACE, KEY, 0.0, num_steps=400, stop=rule)
    assert result.status.message == "best value stalled"
    by_target = any_of(target(30.0), stalled(3, tolerance=1.0))
    result = minimize(sphere, pso(8), SPACE, KEY, 0.0, num_steps=400, stop=by_target)
    assert result.status.message == "target value reached"


def test_a_clock_ends_a_search_that_would_last_long():
    rule = any_of(target(-1.0), time_limit(0.2))
    result = minimize(sphere, pso(8), SPACE, KEY, 0.0, num_steps=10**6, stop=rule)
    assert result.status.message == "time limit reached"
    assert 1 < int(result.num_steps) < 10**6
    keys = jax.random.split(KEY, 3)
    runs = minimize_runs(sphere, pso(8), SPACE, keys, 0.0, num_steps=10**5, stop=time_limit(0.0))
    assert runs.status.message == ["time limit reached"] * 3
    assert runs.num_steps.tolist() == [1, 1, 1]


def test_clocks_start_anew_and_counts_do_not():
    rule = any_of(time_limit(5.0), stalled(3, tolerance=0.5))
    began, (value, when) = renewed(rule, (jnp.float32(3.0), (jnp.asarray(2.0), jnp.int32(7))))
    assert began == time_limit(5.0).start() and float(value) == 2.0 and int(when) == 7


def test_many_runs_tell_their_progress_and_may_have_their_own_data():
    keys, centers, seen = jax.random.split(KEY, 3), jnp.array([0.0, 1.0, 2.0]), []

    def tell(count, values):
        seen.append((int(count), np.asarray(values)))

    options = dict(num_steps=9, args_axes=0, progress=tell, progress_every=3)
    whole = minimize_runs(sphere, pso(8), SPACE, keys, centers, **options)
    jax.effects_barrier()
    assert [count for count, _ in seen] == [3, 6, 9]
    np.testing.assert_array_equal(seen[-1][1], whole.value)
    one = minimize_runs(sphere, pso(8), SPACE, keys, centers, vectorized=False, **options)
    np.testing.assert_allclose(one.value, whole.value)
    for r in range(3):
        single = minimize(sphere, pso(8), SPACE, keys[r], centers[r], num_steps=9)
        np.testing.assert_allclose(single.history, whole.history[r])


def test_shared_and_own_data_over_devices():
    keys, centers = jax.random.split(KEY, 2), jnp.array([0.0, 1.0])

    def scaled(x, args):
        return args[1] * sphere(x, args[0])

    options = dict(num_steps=5, args_axes=(0, None), vectorized=False)
    args, devices = (centers, jnp.asarray(3.0)), jax.devices()[:1]
    spread = minimize_sharded(scaled, pso(8), SPACE, keys, args, devices=devices, **options)
    here = minimize_runs(scaled, pso(8), SPACE, keys, args, **options)
    np.testing.assert_array_equal(spread.history, here.history)


def test_a_search_that_has_ended_by_itself_is_stopped():
    flat = lambda x, _: jnp.zeros(())  # noqa: E731
    optimizer, stop = cma_es(6), search_ended()
    result = minimize(flat, optimizer, SPACE, KEY, num_steps=500, stop=stop)
    assert bool(result.state.finished) and int(result.num_steps) < 100
    assert result.status.message == "the optimizer has ended by criteria of its own"
    keys = jax.random.split(KEY, 3)
    mixed = lambda x, scale: scale * jnp.sum(x**2)  # noqa: E731
    options = dict(num_steps=150, stop=stop, vectorized=False, args_axes=0)
    scales = jnp.array([0.0, 1.0, 0.0])
    runs = minimize_runs(mixed, optimizer, SPACE, keys, scales, **options)
    assert runs.num_steps[0] == runs.num_steps[2] < runs.num_steps[1], "each run ends by itself"
    assert bool(runs.state.finished[0])
    wrapped = minimize(flat, islands(optimizer, 2), SPACE, KEY, num_steps=500, stop=stop)
    assert int(wrapped.num_steps) < 100
    endless = minimize(flat, pso(6), SPACE, KEY, num_steps=20, stop=stop)
    assert int(endless.num_steps) == 20, "a swarm has no criteria of its own"
    driver = Driver(optimizer, SPACE, KEY, num_steps=500, stop=stop)
    while not driver.finished:
        driver.tell(np.zeros(driver.size))
    assert int(driver.result().num_steps) == int(result.num_steps)
