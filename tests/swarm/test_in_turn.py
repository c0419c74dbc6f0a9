"""A search by itself is a program of its own kind, and within another a part of that."""

import jax
import jax.numpy as jnp
import pytest

from jaxswarm.swarm import Space, cma_es, in_turn, minimize
from jaxswarm.swarm.in_turn import InTurn

SPACE = Space.vector([-1.0] * 3, [1.0] * 3)
KEY = jax.random.key(0)


def value(key=KEY, shift=0.1):
    objective = lambda x, shift: jnp.sum((x - shift) ** 2)  # noqa: E731
    return minimize(objective, cma_es(8), SPACE, key, shift, num_steps=20).value


def test_alone_and_within_another_program_are_one_search():
    alone = float(value())
    assert float(jax.jit(value)(KEY)) == pytest.approx(alone, rel=1e-4)
    # Nothing of what is passed on is traced here.
    assert float(jax.jit(lambda: value())()) == pytest.approx(alone, rel=1e-4)
    assert jax.vmap(value)(jnp.stack([KEY, KEY])).tolist() == pytest.approx([alone] * 2, rel=1e-4)
    assert float(jax.vmap(lambda x: x * value())(jnp.ones(2))[1]) == pytest.approx(alone, rel=1e-4)


@pytest.mark.skipif(jax.default_backend() != "cpu", reason="told to the compiler of CPUs")
def test_only_a_search_alone_has_options():
    double = InTurn(jax.jit(lambda x: 2.0 * x))
    double(1.0)
    assert (double._alone._cache_size(), double._within._cache_size()) == (1, 0)
    jax.jit(double)(1.0)
    assert double._alone._cache_size() == 1


def test_a_compiler_without_the_options_compiles_without(monkeypatch):
    monkeypatch.setattr(in_turn, "OPTIONS", {"xla_cpu_no_such_option": False})
    in_turn._known.cache_clear()
    try:
        assert InTurn(jax.jit(lambda x: 2.0 * x))(1.0) == 2.0
    finally:
        in_turn._known.cache_clear()
