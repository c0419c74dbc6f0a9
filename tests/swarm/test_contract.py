"""Every optimizer keeps the contract, alone and inside every wrapper; and the contract can fail."""

from typing import Any, NamedTuple

import chex
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm import testing
from jaxswarm.errors import InputError
from jaxswarm.swarm import (
    OPTIMIZERS,
    aelspso,
    cma_es,
    elitist_learning,
    freeze,
    ga,
    islands,
    pso,
    random_search,
    restart,
    sepso,
    shade,
    spso,
)
from jaxswarm.swarm.own import pytree

WRAPPERS = {
    "elitist_learning": elitist_learning,
    "elitist_in_place": lambda inner: elitist_learning(inner, extra=False),
    "restart": lambda inner: restart(inner, patience=2, keep=True),
    "islands": lambda inner: islands(inner, 2, migrate_every=2),
    "freeze": lambda inner: freeze(inner, [False, True, False], [0.0, 0.25, 0.0]),
}


@pytest.mark.parametrize("name", OPTIMIZERS)
def test_optimizer(name):
    # The long runs of all are those of test_long_runs.
    testing.check_optimizer(OPTIMIZERS[name].factory(8), num_updates=20)


@pytest.mark.parametrize("name", ["gpso", "aelspso", "spso2011", "ga", "lshade", "cma_es"])
def test_optimizer_in_float32(name):
    testing.check_optimizer(OPTIMIZERS[name].factory(8), dtype=jnp.float32, thorough=False)


@pytest.mark.parametrize("variant", ["R2", "R3"])
def test_variants_of_sepso(variant):
    testing.check_optimizer(sepso(8, variant=variant), thorough=False)


def test_threefry():
    testing.check_optimizer(spso(5, random="threefry"), thorough=False)


@pytest.mark.parametrize("name", OPTIMIZERS)
@pytest.mark.parametrize("wrapper", WRAPPERS)
def test_wrapped(name, wrapper):
    optimizer = WRAPPERS[wrapper](OPTIMIZERS[name].factory(8))
    testing.check_optimizer(optimizer, thorough=name == "spso", num_steps=3, num_updates=20)


@pytest.mark.parametrize("outer", WRAPPERS)
@pytest.mark.parametrize("inner", WRAPPERS)
def test_wrappers_nest_in_any_order(outer, inner):
    if outer == inner == "freeze":  # the inner one would have to count the dimensions left
        optimizer = freeze(
            freeze(spso(4), [True, False], [0.5, 0.0]), [True, False, False], [1.0, 0.0, 0.0]
        )
    elif inner == "freeze" or outer != "freeze":
        optimizer = WRAPPERS[outer](WRAPPERS[inner](spso(4)))
    else:
        optimizer = freeze(WRAPPERS[inner](spso(4)), [False, True, False], [0.0, 0.25, 0.0])
    testing.check_optimizer(optimizer, thorough=False, num_steps=3)


class Broken(NamedTuple):
    """Random search with one fault, to see that the contract finds it."""

    fault: int

    def init(self, key, num_dims, dtype=None):
        return random_search(4).init(key, num_dims, dtype)

    def update(self, key, state, value):
        new, info = random_search(4).update(key, state, value)
        faults = [
            lambda: new._replace(position=new.position * 2.0),
            lambda: new._replace(count=state.count),
            lambda: new._replace(best_value=value[0]),
            lambda: new._replace(position=state.position),
            lambda: new._replace(best_position=new.best_position + 0.1),
            lambda: new._replace(count=new.count.astype(float)),
        ]
        if self.fault == len(faults):
            return new, None
        if self.fault > len(faults):
            return new, info._replace(improved=value < 0.0)
        return faults[self.fault](), info


@pytest.mark.parametrize(
    "fault, message",
    enumerate(
        [
            "outside",
            "count does not count",
            "rose|not the lowest",
            "another key gives the same",
            "best_position does not have",
            "changes state.count",
            "info=None has no field value_best",
            r"info.improved has shape \(4,\)",
        ]
    ),
)
def test_the_contract_finds_faults(fault, message):
    optimizer = Broken(fault)
    with pytest.raises(AssertionError, match=message):
        testing.check_optimizer(_Static(optimizer), thorough=False)


@pytree
class Cooled:
    """Divides by what has shrunk: sound for some hundred updates, until that is zero."""

    inner: Any

    def init(self, key, num_dims, dtype=None):
        return self.inner.init(key, num_dims, dtype)

    def update(self, key, state, value):
        new, info = self.inner.update(key, state, value)
        heat = jnp.asarray(0.9, value.dtype) ** state.count
        return new._replace(velocity=new.velocity * heat / heat), info


def test_only_long_runs_find_what_wears_off():
    optimizer = Cooled(pso(8))
    testing.check_optimizer(optimizer, num_updates=20)
    with pytest.raises(AssertionError, match="sphere, after 1500 updates: state.* holds NaN"):
        testing.check_optimizer(optimizer, num_updates=1500)


@jax.tree_util.register_static
class _Static:
    def __init__(self, inner):
        self.inner = inner

    def init(self, *args, **kwargs):
        return self.inner.init(*args, **kwargs)

    def update(self, *args):
        return self.inner.update(*args)

    def __hash__(self):
        return hash(self.inner)

    def __eq__(self, other):
        return self.inner == other.inner


def test_closures_are_optimizers():
    """A NamedTuple of functions has the same interface and runs in minimize."""
    from jaxswarm.swarm import Space, minimize

    inner = random_search(8)

    class Pair(NamedTuple):
        init: object
        update: object

    pair = Pair(*(jax.tree_util.Partial(f) for f in (inner.init, inner.update)))
    space = Space.vector([0.0], [1.0])
    result = minimize(lambda x, _: x[0], pair, space, jax.random.key(0), num_steps=5)
    direct = minimize(lambda x, _: x[0], inner, space, jax.random.key(0), num_steps=5)
    np.testing.assert_array_equal(result.value, direct.value)


def test_what_minimize_takes_is_checked_as_it_is():
    """An object that is no pytree, and functions; a factory is refused and not run."""

    class Plain:
        init, update = staticmethod(random_search(8).init), staticmethod(random_search(8).update)

    testing.check_optimizer(Plain(), thorough=False)
    with pytest.raises(InputError, match="pso is a factory"):
        testing.check_optimizer(pso)


def test_registry_is_complete():
    for name, entry in OPTIMIZERS.items():
        assert entry.factory.__name__ == name
        assert entry.description and entry.reference
    assert [n for n, e in OPTIMIZERS.items() if e.reconstruction] == ["gpso", "sepso"]
    assert {aelspso, cma_es, ga, pso, shade} <= {e.factory for e in OPTIMIZERS.values()}


class TestVariants(chex.TestCase):
    """An update is the same compiled, interpreted and mapped by ``pmap``."""

    @chex.variants(with_jit=True, without_jit=True, with_pmap=True)
    def test_one_step(self):
        for name in ("gpso", "shade", "cma_es", "ga"):
            optimizer = OPTIMIZERS[name].factory(8)
            state = optimizer.init(jax.random.key(0), 3)
            value = jnp.sum(state.position**2, axis=1)

            def step(position, value, optimizer=optimizer, state=state):
                whole = state._replace(position=position) if hasattr(state, "_replace") else state
                return optimizer.update(jax.random.key(1), whole, value)[0].position

            plain = step(state.position, value)
            found = self.variant(step)(state.position, value)
            chex.assert_trees_all_close(found, plain, rtol=1e-5, atol=1e-6)
