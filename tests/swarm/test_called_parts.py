"""What a search and an optimizer are built of and cannot be called so is refused before it fails within."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import optax
import pytest
from jax.sharding import Mesh
from jax.sharding import PartitionSpec as P

from jaxswarm.errors import InputError
from jaxswarm.swarm import (
    Bound,
    Driver,
    Space,
    canonical,
    constrained,
    front,
    ga,
    minimize,
    minimize_runs,
    mopso,
    nsga2,
    plots,
    polish,
    pso,
    recommend,
    ring,
    target,
)

KEY = jax.random.key(0)
SPACE = Space.vector([-5.0] * 2, [5.0] * 2)
NAMED = Space(x=(0.0, 1.0), y=(0.0, 1.0))


def sphere(x, args):
    return jnp.sum((x - 1.0) ** 2)


def search(optimizer=None, fn=sphere, args=None, **options):
    return minimize(fn, optimizer or pso(6), SPACE, KEY, args, num_steps=2, **options)


def rows(x, args):
    return jnp.sum((x - 1.0) ** 2, axis=1)


@functools.cache
def some_runs():
    return minimize_runs(rows, pso(6), SPACE, jax.random.split(KEY, 3), num_steps=3)


@pytest.mark.parametrize(
    "build, message",
    [
        (lambda: search(record=lambda state: state.count), r"record takes \(state\), it is called"),
        (lambda: search(progress=True), "progress=True must be a function of .count, value."),
        (lambda: search(stop=target), "returned|neither a number"),
        (lambda: search(stop=lambda: True), r"stop takes \(\), it is called as stop\(progress\)"),
        (lambda: pso(topology="ring"), "topology='ring' must be a function"),
        (lambda: pso(topology=ring), r"factory. Call it, ring\(\)"),
        (lambda: pso(rule=canonical), r"factory. Call it, canonical\(\)"),
        (lambda: pso(rule=lambda x, v: v), "called as rule.random, swarm, hyper."),
        (lambda: pso(inertia="0.7"), "neither a number nor a schedule"),
        (lambda: ga(mutation=lambda x: x), "called as mutation.random, position."),
        (lambda: nsga2(selection="best"), "must be a function of .random, value."),
        (lambda: mopso(boundary=jnp.clip, rule=3), "rule=3 must be a function"),
        (lambda: search(pso(6, topology=lambda r, p, v: p[0])), r"topology returned shape \(2,\)"),
        (lambda: search(pso(6, rule=lambda r, s, h: s.velocity[0])), "rule returned shape"),
        (lambda: search(pso(6, rule=lambda r, s, h: None)), "rule returned None"),
        (lambda: search(pso(6, boundary=lambda r, p, v: p)), "return .position, velocity."),
        (lambda: search(pso(6, boundary=lambda r, p, v: (p, v[0]))), "boundary returned shape"),
        (lambda: search(optax.adam(0.1)), "init takes .params.*polish"),
        (lambda: search(args={"name": "arm"}), r"args\['name'\] is a str, no number"),
        (lambda: search(args=object()), "args is a object, no number"),
        (lambda: polish(sphere, SPACE, jnp.full((1, 2), 0.5), "text"), "args is a str"),
        (
            lambda: search(fn=lambda x, a: (x[0], x)),
            "a tuple of 2, which is no number.*constrained",
        ),
        (lambda: search(fn=lambda x, a: x), r"shape \(2,\).*nsga2"),
        (
            lambda: minimize_runs(sphere, pso(6), SPACE, jax.random.split(KEY, 2), num_steps=2),
            "pass vectorized=False",
        ),
        (lambda: constrained(nsga2(2, 8), 1), "compares several numbers a candidate"),
        (lambda: Space(x=(False, True)), "Choice..False, True."),
        (lambda: Space(x=Bound(0.0, True)), "Choice..False, True."),
        (lambda: NAMED.decode(jnp.zeros((5, 2))), "a population by jax.vmap"),
        (lambda: NAMED.decode(jnp.zeros(3)), "position has shape .3,., the space 2"),
        (lambda: SPACE.decode(jnp.zeros(3)), "position has shape .3,., the space 2"),
        (
            lambda: Driver(pso(6), SPACE, KEY, num_steps=2).tell({i: 1.0 for i in range(6)}),
            "value is a dict: tell a list",
        ),
        (lambda: plots.convergence_bands(np.ones((2, 3))), "has no name in the picture"),
        (lambda: plots.front_plot(np.ones((2, 3))), "has no name in the picture"),
    ],
)
def test_refused_before_it_fails_within(build, message):
    with pytest.raises(InputError, match=message):
        build()


def test_a_code_of_ones_own_has_a_text():
    found = search(stop=lambda progress: (progress.count >= 1, 99))
    assert found.status.message == "stopped by the given rule, code 99" and "99" in repr(found)


def test_a_point_may_be_a_list_and_a_name_self():
    np.testing.assert_array_equal(SPACE.decode([0.5, 0.5]), [0.0, 0.0])
    assert Space(**{"self": (0.0, 1.0)}).names == ("self",)


def test_pictures_take_results_and_readers_of_results_take_states():
    found = some_runs()
    one, other = (plots.convergence_bands({"pso": h}) for h in (found, found.history))
    drawn = [figure.axes[0].lines[0].get_ydata() for figure in (one, other)]
    np.testing.assert_array_equal(*drawn)
    single = search()
    np.testing.assert_array_equal(recommend(single.state, SPACE), recommend(single, SPACE))
    two = search(nsga2(2, 8), lambda x, _: (x[0], -x[0]))
    np.testing.assert_array_equal(front(two.state, SPACE).values, front(two, SPACE).values)


def test_many_runs_are_polished_from_the_best_of_all():
    found = some_runs()
    polished = polish(sphere, SPACE, found, num_steps=30, top=2)
    np.testing.assert_allclose(polished.start_value, found.value.min(), rtol=1e-6)
    assert polished.value < 1e-9 < found.value.min()


def test_within_shard_map_it_is_told_what_to_give():
    mesh = Mesh(jax.devices()[:1], ("devices",))
    one = jax.vmap(lambda key: minimize(sphere, pso(6), SPACE, key, num_steps=3).value)
    keys = jax.random.split(KEY, 2)
    parts = dict(mesh=mesh, in_specs=P("devices"), out_specs=P("devices"))
    with pytest.raises(InputError, match="check_vma=False"):
        jax.shard_map(one, **parts)(keys)
    mapped = jax.shard_map(one, **parts, check_vma=False)(keys)
    np.testing.assert_allclose(mapped, one(keys), rtol=1e-6)
