"""What an optimizer or a space may be given, and what is refused at once, with the remedy."""

import functools
from typing import Any, NamedTuple

import chex
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.swarm import (
    OPTIMIZERS,
    Bound,
    Driver,
    Space,
    any_of,
    cma_es,
    constrained,
    de,
    elitist_learning,
    freeze,
    islands,
    minimize,
    minimize_resumable,
    minimize_runs,
    minimize_sharded,
    polish,
    pso,
    restart,
    spso2011,
    target,
)
from jaxswarm.swarm.optimizers.base import as_optimizer
from jaxswarm.swarm.polish import _candidates, _distinct

KEY = jax.random.key(0)
SPACE = Space.vector([-5.0] * 2, [5.0] * 2)
SWARM = pso(6)
KEYS = jax.random.split(KEY, 2)


class Pair(NamedTuple):
    init: Any
    update: Any


class Methods:
    def init(self, key, num_dims, dtype=None):
        return SWARM.init(key, num_dims, dtype)

    def update(self, key, state, value):
        return SWARM.update(key, state, value)


def sphere(x, center):
    return jnp.sum((x - center) ** 2)


def search(optimizer, **options):
    return minimize(sphere, optimizer, SPACE, KEY, 1.0, num_steps=4, **options)


def says(value):
    return minimize(lambda x, _: value, SWARM, SPACE, KEY, num_steps=2)


def runs(keys, many=minimize_runs, **options):
    return many(lambda x, _: x[:, 0], SWARM, SPACE, keys, num_steps=2, **options)


def told(fn, **options):
    return Driver(SWARM, SPACE, KEY, num_steps=2).run(fn, **options)


@pytest.mark.parametrize("optimizer", [Pair(SWARM.init, SWARM.update), Methods()])
def test_functions_and_objects_are_optimizers(optimizer):
    np.testing.assert_array_equal(search(optimizer).history, search(SWARM).history)
    assert restart(optimizer).init(KEY, 2).position.shape == (6, 2)


@pytest.mark.parametrize(
    "build, message",
    [
        (lambda: search(pso), r"optimizer=pso is a factory.*call it, pso\(\)"),
        (lambda: restart(pso), "factory"),
        (lambda: elitist_learning(de), "factory"),
        (lambda: freeze(de, [True, False], [0.5, 0.5]), "factory"),
        (lambda: islands([pso(6), de(6)]), "list of 2: give a single optimizer; islands"),
        (lambda: search(3.0), "no init and update"),
        (lambda: search(Pair(SWARM.init, lambda k, s, v: (s, None))), "info=None.*value_best"),
        (lambda: minimize(sphere, SWARM, [(0, 1)], KEY, num_steps=2), "must be a Space"),
        (lambda: Space.vector([0.0] * 3, [1.0] * 3, names=["a"]), "names has 1 entries, lower 3"),
        (lambda: Space.vector([0.0] * 2, [1.0] * 2, scale=["linear"]), "scale has 1 entries"),
        (lambda: Space.vector([0.0] * 2, [1.0] * 2, units=["m"] * 3), "units has 3 entries"),
        (lambda: Space.vector([0.0] * 2, [1.0] * 3), "shape"),
        (lambda: Space(a=(0.0, 1.0)).encode({"b": 0.5}), r"\['a'\] missing, \['b'\] unknown"),
        (lambda: SPACE.encode(jnp.ones(3)), "params hold 3 numbers"),
        (lambda: SPACE.encode(0.5), "params hold 1 numbers"),
        (lambda: SPACE.encode({"x": 0.5}), r"x\[0\]: .* is no number"),
        (lambda: says(None), "fn returned None, which is no number"),
        (lambda: says("low"), "fn returned 'low', which is no number"),
        (lambda: says({"cost": 1.0}), "which is no number"),
        (lambda: says(1.0j), "fn returned complex.* numbers, which have no order"),
        (lambda: Space(x=(0.0, 1.0 + 1.0j)), "is no number"),
        (lambda: Space(x=(-1e308, 1e308)), "it is inf in float64"),
        (lambda: Space(x=Bound(np.float32(-3e38), np.float32(3e38))), "it is inf in float32"),
        (lambda: Space(x=Bound(1e-200, 1e200, "log")), "a log scale does not reach from"),
        (lambda: search(SWARM, start=np.zeros((0, 2))), "start holds no points"),
        (lambda: search(SWARM, stop=any_of([target(0.0)])), "give rules one by one"),
        (lambda: search(SWARM, stop=lambda progress: progress.value < 1.0), "return .done, code."),
        (lambda: runs(KEY), r"keys have shape \(\): give one a run"),
        (lambda: runs(jax.random.split(KEY, 0)), r"keys have shape \(0,\)"),
        (lambda: runs(jax.random.PRNGKey(0)), r"keys have shape \(\)"),
        (lambda: runs(0), "key=0 is no JAX key"),
        (lambda: runs([KEY, KEY]), "is no JAX key"),
        (lambda: runs(KEYS, args=1.0, args_axes=(0,)), "give args as a tuple"),
        (lambda: runs(KEYS, minimize_sharded, devices=[]), "devices is empty"),
        (lambda: runs(0, minimize_sharded), "key=0 is no JAX key"),
        (
            lambda: runs(KEYS, state=runs(KEYS[:1]).state),
            "state is other: shape of .*number of runs",
        ),
        (
            lambda: search(de(6), state=search(SWARM).state),
            "state is PSOState, this search has DEState",
        ),
        (lambda: search(pso(7), state=search(SWARM).state), "state is other: shape of"),
        (lambda: search(SWARM, state=search(SWARM)), "state=result.state"),
        (
            lambda: Driver(pso(7), SPACE, KEY, num_steps=2, state=search(SWARM).state),
            "state is other",
        ),
        (lambda: told(lambda x: None), "None is no number"),
        (lambda: told(lambda x: 1.0j), "Tell a number for each candidate"),
        (lambda: told(lambda x: 1.0, vectorized=True), "Tell a number for each candidate"),
    ],
)
def test_refused_at_once(build, message):
    with pytest.raises(InputError, match=message):
        build()


@pytest.mark.parametrize("name", OPTIMIZERS)
@pytest.mark.parametrize("shape", [(), (3,)])
def test_another_number_of_values_is_refused(name, shape):
    optimizer = OPTIMIZERS[name].factory(8)
    state = jax.eval_shape(lambda key: optimizer.init(key, 2), KEY)
    with pytest.raises(InputError, match="one value for each row"):
        jax.eval_shape(optimizer.update, KEY, state, jax.ShapeDtypeStruct(shape, float))


@pytest.mark.parametrize("name", OPTIMIZERS)
def test_the_prototype_of_a_state_needs_no_numbers(name):
    optimizer = elitist_learning(restart(islands(OPTIMIZERS[name].factory(8), 2)))
    state = jax.eval_shape(optimizer.init, KEY, SPACE)
    chex.assert_trees_all_equal_shapes_and_dtypes(state, optimizer.init(KEY, SPACE.size))
    for init in (optimizer.init, OPTIMIZERS[name].factory().init):
        with pytest.raises(InputError, match="num_dims is traced.*give a Space.*partial"):
            jax.eval_shape(init, KEY, 2)
    closed = jax.eval_shape(functools.partial(optimizer.init, num_dims=2), KEY)
    chex.assert_trees_all_equal_shapes_and_dtypes(state, closed)


def test_a_number_of_dimensions_is_a_whole_number():
    for wrong in (0, 2.5, True):
        with pytest.raises(InputError, match="num_dims="):
            SWARM.init(KEY, wrong)
    held = freeze(SWARM, [True, False], [0.5, 0.5])
    assert held.init(KEY, SPACE).position.shape == (6, 2)


def test_bounds_are_mapped_and_differentiated():
    def best(width):
        space = Space(a=(-width, width))
        return minimize(lambda p, _: (p["a"] - 3.0) ** 2, SWARM, space, KEY, num_steps=9).value

    widths = jnp.array([1.0, 2.0])
    np.testing.assert_allclose(jax.vmap(best)(widths), [4.0, 1.0], rtol=1e-2)
    assert float(jax.grad(best)(1.0)) == pytest.approx(-4.0, rel=1e-2)

    def flat(width):
        space = Space.vector(-width, width)
        return minimize(sphere, SWARM, space, KEY, 0.0, num_steps=3).params

    assert jax.vmap(flat)(jnp.ones((2, 3))).shape == (2, 3)


def test_gradients_through_a_ball_rule_are_finite():
    def best(inertia):
        return minimize(sphere, spso2011(6, inertia=inertia), SPACE, KEY, 1.0, num_steps=6).value

    slope, difference = float(jax.grad(best)(0.7)), float(best(0.7 + 1e-6) - best(0.7 - 1e-6))
    assert slope == pytest.approx(difference / 2e-6, rel=1e-4)


def test_reverse_mode_with_a_stop_rule_is_told_and_forward_mode_works():
    def best(center, stop):
        return minimize(sphere, SWARM, SPACE, KEY, center, num_steps=4, stop=stop).value

    for through in (jax.grad(best), jax.grad(jax.jit(best))):
        with pytest.raises(InputError, match="no reverse mode.*Leave stop out"):
            through(1.0, target(-1.0))
    with pytest.raises(InputError, match="no reverse mode"):
        jax.grad(lambda centers: jax.vmap(best, (0, None))(centers, target(-1.0)).sum())(
            jnp.ones(2)
        )
    forward = jax.jacfwd(best)(1.0, target(-1.0))
    assert float(forward) == pytest.approx(float(jax.jacfwd(best)(1.0, None)))


def test_polish_starts_at_points_that_differ():
    members = jnp.array([[0.5, 0.51], [0.5, 0.51], [0.5, 0.51], [0.2, 0.3], [0.9, 0.9]])
    state = de(5).init(KEY, 2)._replace(members=members, best_position=members[0])
    points = _candidates(state)
    starts = _distinct(points, jnp.sum((points - 0.5) ** 2, axis=1), 4)
    np.testing.assert_allclose(starts, [[0.5, 0.51], [0.2, 0.3], [0.9, 0.9], [0.5, 0.51]])
    wrapped = restart(de(5)).init(KEY, 2)
    assert _candidates(wrapped._replace(inner=state)).shape == (6, 2)
    # Two valleys, the deeper one where only a worse member lies.
    two = lambda x, _: jnp.minimum(jnp.sum(x**2) + 1.0, 5.0 * jnp.sum((x - 3.5) ** 2))  # noqa: E731
    assert float(polish(two, SPACE, state, num_steps=20, top=3).value) < 0.5
    assert float(polish(two, SPACE, state, num_steps=20, top=1).value) >= 1.0


def test_a_result_reads_as_one_line():
    long = Space.vector([-1.0] * 40, [1.0] * 40)
    wide = repr(minimize(sphere, SWARM, long, KEY, 0.0, num_steps=1))
    assert "\n" not in wide and len(wide) < 400
    text = repr(search(SWARM))
    assert len(text) < 300 and "value=" in text and "all steps done" in text
    assert "history" not in text and "PSOState" in text
    runs = jax.vmap(lambda key: minimize(sphere, SWARM, SPACE, key, 0.0, num_steps=2))
    assert "3 runs" in repr(runs(jax.random.split(KEY, 3)))
    assert "Result" in repr(jax.tree.map(jnp.shape, search(SWARM)))


def test_a_checkpoint_without_a_folder_is_refused_before_the_first_step(tmp_path):
    where = tmp_path / "no" / "such"
    with pytest.raises(InputError, match="there is no folder .*such"):
        minimize_resumable(sphere, SWARM, SPACE, KEY, 1.0, num_steps=2, path=where / "kept")
    with pytest.raises(InputError, match="key=0 is no JAX key"):
        minimize_resumable(sphere, SWARM, SPACE, 0, 1.0, num_steps=2, path=tmp_path / "kept")


def test_bounds_of_half_a_precision_are_searched_in_a_single_one():
    """Values above 65504 are infinite in float16, and it has no eigenvectors: ``cma_es`` failed."""
    space = Space.vector(*np.full((2, 2), [[-5.0], [5.0]], np.float16))
    found = minimize(
        lambda x, _: 1e6 + jnp.sum(x**2), cma_es(), space, KEY, num_steps=20, stop=target(1e6 + 0.1)
    )
    assert found.value.dtype == found.params.dtype == jnp.float32
    assert bool(found.status.ok) and found.status.message == "target value reached"


def test_a_host_objective_returns_value_and_constraints_as_one_on_the_device_does():
    def disc(x):
        return -x[0], [x[0] ** 2 + x[1] ** 2 - 1.0]

    driver = Driver(constrained(SWARM, 1), SPACE, KEY, num_steps=3)
    ours = driver.run(lambda x: disc(x) if x[0] < 4.0 else 1 / 0, forgive=(ZeroDivisionError,))
    jitted = lambda x, _: (jnp.where(x[0] < 4.0, -x[0], jnp.inf), disc(x)[1][0])  # noqa: E731
    theirs = minimize(jitted, constrained(SWARM, 1), SPACE, KEY, num_steps=3)
    np.testing.assert_allclose(ours.params, theirs.params, rtol=1e-6)


def test_as_optimizer_keeps_what_is_one():
    assert as_optimizer(SWARM) == SWARM


UNTRACED = {
    "NumPy": lambda x, _: np.sum(np.square(np.asarray(x))),
    "if": lambda x, _: 1.0 if x[0] > 0.0 else 2.0,
    "a mask": lambda x, _: x[x > 0.0].sum(),
    "an index": lambda x, _: [1.0, 2.0][x[0].astype(int)],
}


@pytest.mark.parametrize("name", UNTRACED)
def test_what_cannot_be_compiled_is_sent_to_the_driver(name):
    with pytest.raises(InputError, match="search with Driver"):
        minimize(UNTRACED[name], SWARM, SPACE, KEY, num_steps=1)


@pytest.mark.parametrize(
    "search",
    [
        lambda fn: minimize(fn, SWARM, SPACE, KEY, num_steps=1),
        lambda fn: minimize_runs(fn, SWARM, SPACE, KEYS, num_steps=1),
        lambda fn: minimize(fn, SWARM, SPACE, KEY, num_steps=1, noisy=True),
        lambda fn: polish(fn, SPACE, jnp.zeros(2)),
    ],
)
def test_a_function_that_takes_something_else_is_refused_before_it_is_called(search):
    def one(x):
        raise AssertionError

    with pytest.raises(InputError, match=r"fn takes \(x\), it is called as fn\(.*params, args\)"):
        search(one)


def test_a_driver_calls_with_parameters_alone():
    driver = Driver(SWARM, SPACE, KEY, num_steps=1)
    with pytest.raises(InputError, match=r"called as fn\(params\)"):
        driver.run(sphere)
    with pytest.raises(InputError, match="one number for each candidate"):
        driver.run(lambda x: np.array([1.0]))


def test_polish_takes_a_result_and_refuses_another_order():
    found = minimize(sphere, SWARM, SPACE, KEY, 1.0, num_steps=2)
    by_result, by_state = (polish(sphere, SPACE, x, 1.0) for x in (found, found.state))
    np.testing.assert_array_equal(by_result.position, by_state.position)
    with pytest.raises(InputError, match="must be a Space"):
        polish(sphere, found, SPACE)
