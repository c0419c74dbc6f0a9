"""Everything works as well where JAX is asked to be strict: nothing is promoted, transferred or leaked unasked.

What a mode refuses is refused while a program is traced, so most here is traced and not compiled.
"""

from contextlib import ExitStack

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.swarm import (
    OPTIMIZERS,
    Bound,
    Choice,
    Driver,
    Space,
    aelspso,
    any_of,
    around,
    augmented_lagrangian,
    averaged,
    cma_es,
    collapsed,
    constrained,
    de,
    elitist_learning,
    epsilon_level,
    feasibility_rules,
    freeze,
    front,
    gpso,
    ipop_cma_es,
    islands,
    lshade,
    minimize,
    minimize_resumable,
    minimize_runs,
    minimize_sharded,
    mopso,
    nsga2,
    polish,
    pso,
    recommend,
    reevaluate,
    restart,
    search_ended,
    sepso,
    snes,
    stalled,
    target,
    time_limit,
)

TRACED = {
    "dtypes": lambda: [jax.numpy_dtype_promotion("strict")],
    "dtypes without x64": lambda: [jax.numpy_dtype_promotion("strict"), jax.enable_x64(False)],
    "ranks": lambda: [jax.numpy_rank_promotion("raise")],
    "leaks": lambda: [jax.checking_leaks()],
}
WRAPPED = {
    "elitist_learning": lambda: elitist_learning(cma_es(8)),
    "elitist_learning in place": lambda: elitist_learning(pso(8), on_failure="replace worst"),
    "restart": lambda: restart(lshade(8), patience=2),
    "islands": lambda: islands(elitist_learning(de(8)), 2),
    "freeze": lambda: freeze(ipop_cma_es(8), [False, True, False], [0.0, 0.25, 0.0]),
    "reevaluate": lambda: reevaluate(pso(8)),
    "sepso R2": lambda: sepso(8, variant="R2"),
    "aelspso as APSO": lambda: aelspso(8, adapt_coefficients=True, gate="convergence"),
    "many rows": lambda: cma_es(200),
}
CUBE = Space.vector([-5.0] * 3, [5.0] * 3)
MIXED = Space(
    a=(0.0, 1.0), b=Bound(0.1, 10.0, "log"), c=Bound(1, 7, "integer"), k=Choice(("x", "y"))
)


def strictly(mode):
    stack = ExitStack()
    for context in TRACED[mode]():
        stack.enter_context(context)
    return stack


def sphere(x, _):
    return jnp.sum(x**2)


def spheres(x, _):
    return jnp.sum(x**2, axis=1)


def traced(optimizer, fn=sphere, where=CUBE, **options):
    options = {"num_steps": 2} | options
    jax.eval_shape(lambda key: minimize(fn, optimizer, where, key, **options), key_like())


def key_like():
    return jax.eval_shape(lambda: jax.random.key(0))


@pytest.mark.parametrize("mode", TRACED)
@pytest.mark.parametrize("name", OPTIMIZERS)
def test_every_optimizer(name, mode):
    with strictly(mode):
        traced(OPTIMIZERS[name].factory(8))


@pytest.mark.parametrize("mode", TRACED)
@pytest.mark.parametrize("name", WRAPPED)
def test_wrappers_and_variants(name, mode):
    with strictly(mode):
        traced(WRAPPED[name]())


@pytest.mark.parametrize("mode", TRACED)
def test_parts_of_a_search(mode):
    back = stalled(5, tolerance=1e-3, relative=1e-3)
    stop = any_of(target(1e-3), stalled(5), collapsed(1e-5), back, search_ended(), time_limit(9.0))
    rough = averaged(lambda k, x, _: jnp.sum(x**2) + jax.random.normal(k, dtype=x.dtype), 3)
    with strictly(mode):
        for optimizer in (pso(8), cma_es(8)):
            traced(optimizer, stop=stop, progress=lambda count, value: None)
            traced(optimizer, start=around(np.ones(3), 0.1))
            traced(optimizer, rough, noisy=True)
        traced(snes(8), start=np.ones((4, 3)))
        traced(pso(8), lambda p, _: p["a"] * p["b"], MIXED)


@pytest.mark.parametrize("mode", TRACED)
def test_runs(mode):
    def runs(key):
        keys = jax.random.split(key, 4)
        options = dict(num_steps=2, start=np.ones(3))
        minimize_runs(spheres, gpso(8), CUBE, keys, stop=stalled(3), **options)
        own = dict(vectorized=False, args_axes=0)
        shifts = jnp.ones(4, CUBE.dtype)
        return minimize_runs(
            lambda x, a: jnp.sum((x - a) ** 2), pso(8), CUBE, keys, shifts, num_steps=2, **own
        )

    with strictly(mode):
        jax.eval_shape(runs, key_like())


@pytest.mark.parametrize("mode", TRACED)
def test_constraints_and_fronts(mode):
    def bounded(x, _):
        return jnp.sum(x**2), jnp.stack([x[0] - 1.0, x[1]])

    handlings = (feasibility_rules(), augmented_lagrangian(), epsilon_level(10))
    with strictly(mode):
        for handling in handlings:
            traced(constrained(cma_es(8), 2, handling=handling, num_equalities=1), bounded)
        for optimizer in (nsga2(2, 8), mopso(2, 8)):
            traced(islands(optimizer, 2), lambda x, _: (jnp.sum(x**2), jnp.sum((x - 1.0) ** 2)))


@pytest.mark.parametrize("mode", TRACED)
@pytest.mark.parametrize("method", ["lbfgs", "adam", "levenberg_marquardt"])
def test_polish(method, mode):
    fn = (lambda x, _: x) if method == "levenberg_marquardt" else sphere
    with strictly(mode):
        start = jax.ShapeDtypeStruct((2, 3), CUBE.dtype)
        jax.eval_shape(lambda x: polish(fn, CUBE, x, method=method, num_steps=2), start)


@pytest.fixture
def guarded(key):
    """Keys made beforehand: to make one is a transfer. Then nothing is transferred unasked."""
    keys = jax.random.split(key, 4)
    with jax.transfer_guard("disallow"):
        yield keys


@pytest.mark.parametrize("name", OPTIMIZERS)
def test_under_a_transfer_guard_and_with_nans_told(name, guarded, key):
    few = {"num_doublings": 1} if name in ("ipop_cma_es", "bipop_cma_es") else {}
    with jax.debug_nans(True):
        result = minimize(sphere, OPTIMIZERS[name].factory(8, **few), CUBE, key, num_steps=2)
    assert np.isfinite(jax.device_get(result.value))


def test_going_on_under_a_transfer_guard(guarded, key):
    options = dict(num_steps=2, progress=lambda count, value: float(value))
    stop = any_of(target(-1.0), stalled(5, tolerance=1e-3), time_limit(100.0))
    result = minimize(
        sphere, gpso(8), CUBE, key, start=around([1.0] * 3, 0.1), stop=stop, **options
    )
    result = minimize(sphere, gpso(8), CUBE, key, state=result.state, stop=stop, **options)
    assert result.status.message == "all steps done" and "8" in repr(result)
    assert recommend(result, CUBE).shape == (3,)
    assert polish(sphere, CUBE, result, num_steps=2).position.shape == (3,)


def test_runs_under_a_transfer_guard(guarded):
    shared = minimize_runs(spheres, gpso(8), CUBE, guarded, num_steps=2)
    spread = minimize_sharded(
        spheres, gpso(8), CUBE, guarded, num_steps=2, devices=jax.devices()[:1]
    )
    np.testing.assert_array_equal(jax.device_get(shared.value), jax.device_get(spread.value))


def test_resuming_under_a_transfer_guard(guarded, tmp_path):
    options = dict(
        num_steps=4, every=2, path=tmp_path / "search", stop=any_of(stalled(9), time_limit(99.0))
    )
    first, again = (
        minimize_resumable(sphere, gpso(8), CUBE, guarded, **options, vectorized=False)
        for _ in range(2)
    )
    np.testing.assert_array_equal(jax.device_get(first.history), jax.device_get(again.history))


def test_ask_and_tell_under_a_transfer_guard(guarded, key):
    driver = Driver(cma_es(8), MIXED, key, num_steps=2, stop=stalled(9))
    result = driver.run(lambda params: float(params["a"]))
    assert result.status.message == "all steps done" and len(driver.history) == 2


def test_fronts_under_a_transfer_guard(guarded, key):
    both = lambda x, _: (jnp.sum(x**2), jnp.sum((x - 1.0) ** 2))  # noqa: E731
    result = minimize(both, nsga2(2, 8), CUBE, key, num_steps=2)
    assert front(result, CUBE).values.shape[1] == 2


def test_data_of_the_user_are_left_to_the_guard(guarded, key):
    """The guard is there to find just this: data that every call transfers anew."""
    shifted = lambda x, shift: jnp.sum((x - shift) ** 2)  # noqa: E731
    with pytest.raises(jax.errors.JaxRuntimeError, match="Disallowed host-to-device transfer"):
        minimize(shifted, pso(8), CUBE, key, np.ones(3), num_steps=2)
    shift = jax.device_put(np.ones(3))
    assert minimize(shifted, pso(8), CUBE, key, shift, num_steps=2).value.shape == ()
