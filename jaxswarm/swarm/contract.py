"""The contract of an optimizer, as code: run it on your own.

What ``minimize``, the wrappers, ``vmap`` and checkpoints rely on is checked here for one optimizer,
with a sentence for what does not hold. All of ours pass it, alone and inside every wrapper.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.swarm.endurance import NUM_UPDATES, endure, faults
from jaxswarm.swarm.optimizers.base import Info, as_optimizer

__all__ = ["check_optimizer"]

FIELDS = ("position", "best_position", "best_value", "count")


def check_optimizer(
    optimizer: Any,
    *,
    num_dims: int = 3,
    num_steps: int = 4,
    key: jax.Array | None = None,
    dtype: Any = None,
    thorough: bool = True,
    num_updates: int = NUM_UPDATES,
) -> None:
    """Raise ``AssertionError``, saying what is wrong, unless ``optimizer`` keeps the contract.

    Checked: the state has ``position (n, d)``, ``best_position (d,)``, ``best_value ()``, ``count
    ()`` and keeps its structure, shapes and dtypes; an update tells all of ``Info``; positions lie in
    [0, 1]; the best value never rises and is that of a candidate; ``count`` counts; the same key gives
    the same step and another key another; ``jit`` and ``vmap`` change nothing; a second step, or other
    numbers in the optimizer, compile nothing; NaN and infinite values are survived, also if there are no
    others; ten thousand updates past convergence, and where values do not differ, leave no NaN behind, in
    float32 too (:mod:`~jaxswarm.swarm.endurance`).

    Args:
      optimizer: anything with ``init`` and ``update``, as ``minimize`` takes it.
      num_dims: d of the test problem, a sphere off the center.
      num_steps: updates in a row.
      key: JAX key; default ``jax.random.key(0)``.
      dtype: of the positions; default JAX's float.
      thorough: whether to compare with the eager and the mapped update and to make the long runs,
        which takes longest.
      num_updates: length of the long runs.

    Raises:
      AssertionError: what is above.
      InputError: a factory, or something without these two functions.

    >>> from jaxswarm.swarm import pso
    >>> check_optimizer(pso(5), num_updates=100)
    """
    optimizer = as_optimizer(optimizer)
    dtype = jnp.result_type(float if dtype is None else dtype)
    key = jax.random.key(0) if key is None else key
    keys = jax.random.split(key, num_steps + 1)
    start = optimizer.init(keys[0], num_dims, dtype=dtype)
    _check_state(start, num_dims, dtype)

    jitted = jax.jit(lambda o, k, s, v: o.update(k, s, v))
    states = _check_search(optimizer, jitted, keys, start)
    _check_numbers(optimizer, jitted, keys, states[-1])
    _check_keys(optimizer, jitted, keys, states[1])
    if thorough:
        _check_jit(optimizer, jitted, keys, states[1])
        _check_vmap(optimizer, jitted, keys, states[1])
    _check_bad_values(optimizer, jitted, keys, states[1])
    if thorough:
        for precision in dict.fromkeys([dtype, jnp.dtype("float32")]):  # whose digits end first
            runs = endure(optimizer, num_dims, keys[0], precision, num_updates)
            found = faults(runs)
            _require(not found, "; ".join(found))


def _check_state(state, num_dims, dtype):
    for name in FIELDS:
        _require(hasattr(state, name), f"the state has no field {name}")
    n = state.position.shape[0]
    shapes = {
        "position": (n, num_dims),
        "best_position": (num_dims,),
        "best_value": (),
        "count": (),
    }
    for name, shape in shapes.items():
        found = jnp.shape(getattr(state, name))
        _require(found == shape, f"state.{name} has shape {found}, expected {shape}")
    for name in FIELDS[:3]:
        found = getattr(state, name).dtype
        _require(found == dtype, f"state.{name} has dtype {found}, expected {dtype}")
    _require(int(state.count) == 0, "state.count does not begin at 0")
    _require(bool(jnp.isposinf(state.best_value)), "state.best_value does not begin at +inf")


def _check_search(optimizer, jitted, keys, state):
    states, seen = [state], []
    for step, key in enumerate(keys[1:]):
        _require_cube(state.position)
        value = _sphere(state.position)
        seen.append((np.asarray(state.position), np.asarray(value)))
        new, info = jitted(optimizer, key, state, value)
        _require_like(state, new)
        _check_info(info)
        _require(int(new.count) == step + 1, "count does not count the updates")
        _require(bool(new.best_value <= state.best_value), "the best value rose")
        state = new
        states.append(state)
    lowest = min(value.min() for _, value in seen)
    _require(float(state.best_value) == float(lowest), "the best value is not the lowest seen")
    at_best = np.asarray(_sphere(state.best_position[None]))[0]
    _require(np.isclose(at_best, lowest, rtol=1e-5), "best_position does not have the best value")
    _require(jitted._cache_size() == 1, "a later update compiled again")
    return states


def _check_info(info):
    for name in Info._fields:
        _require(hasattr(info, name), f"info={info!r} has no field {name}")
    for name in Info._fields[:-1]:
        found = jnp.shape(getattr(info, name))
        _require(found == (), f"info.{name} has shape {found}, expected ()")


def _check_numbers(optimizer, jitted, keys, state):
    """Leaves are numbers that may change; the program stays."""
    scaled = jax.tree.map(lambda leaf: leaf * 0.875, optimizer)
    jitted(scaled, keys[0], state, _sphere(state.position))
    _require(jitted._cache_size() == 1, "changing numbers of the optimizer compiled again")


def _check_keys(optimizer, jitted, keys, state):
    value = _sphere(state.position)
    new, _ = jitted(optimizer, keys[0], state, value)
    again, _ = jitted(optimizer, keys[0], state, value)
    other, _ = jitted(optimizer, keys[1], state, value)
    _require(_same(new, again), "the same key does not give the same step")
    _require(not _same(new.position, other.position), "another key gives the same candidates")


def _check_jit(optimizer, jitted, keys, state):
    value = _sphere(state.position)
    new, _ = jitted(optimizer, keys[0], state, value)
    eager, _ = optimizer.update(keys[0], state, value)
    _require_close(new, eager, "jit changes the result")


def _check_vmap(optimizer, jitted, keys, state):
    value = _sphere(state.position)
    each = [jitted(optimizer, key, state, value)[0] for key in keys[:2]]
    mapped, _ = jax.jit(jax.vmap(lambda k: optimizer.update(k, state, value)))(keys[:2])
    for i in range(2):
        _require_close(each[i], jax.tree.map(lambda leaf, i=i: leaf[i], mapped), "vmap differs")


def _check_bad_values(optimizer, jitted, keys, state):
    n = state.position.shape[0]
    value = _sphere(state.position) + 1e3
    value = value.at[0].set(jnp.nan).at[n - 1].set(jnp.inf)
    new, _ = jitted(optimizer, keys[0], state, value)
    _require(bool(new.best_value == state.best_value), "a NaN value disturbed the best value")
    _require_cube(new.position)
    state = optimizer.init(keys[0], state.position.shape[1], dtype=state.position.dtype)
    for key in keys[:2]:
        state, _ = jitted(optimizer, key, state, jnp.full(n, jnp.nan, state.position.dtype))
        _require_cube(state.position)
    _require(bool(jnp.isposinf(state.best_value)), "NaN values gave a best value")
    value = _sphere(state.position)
    state, _ = jitted(optimizer, keys[0], state, value)
    _require(bool(state.best_value == value.min()), "no recovery after steps without a value")
    _require_cube(state.position)


def _sphere(position):
    return jnp.sum((position - 0.3) ** 2, axis=-1)


def _require(holds, message):
    if not holds:
        raise AssertionError(message)


def _require_cube(position):
    inside = bool(jnp.all((position >= 0.0) & (position <= 1.0)))
    _require(inside, f"a candidate is outside [0, 1] or not finite: {position}")


def _require_like(old, new):
    olds, news = jax.tree_util.tree_structure(old), jax.tree_util.tree_structure(new)
    _require(olds == news, f"update changes the structure of the state from {olds} to {news}")
    named = jax.tree_util.tree_flatten_with_path(old)[0]
    for (path, a), b in zip(named, jax.tree.leaves(new), strict=True):
        with _saying(f"update changes state{jax.tree_util.keystr(path)}"):
            _chex().assert_trees_all_equal_shapes_and_dtypes(a, b)


def _same(a, b):
    try:
        _chex().assert_trees_all_equal(a, b)
    except AssertionError:
        return False
    return True


def _require_close(a, b, message):
    named = jax.tree_util.tree_flatten_with_path(a)[0]
    for (path, x), y in zip(named, jax.tree.leaves(b), strict=True):
        tolerance = 1e-4 if x.dtype == jnp.float32 else 1e-9
        with _saying(f"{message} in state{jax.tree_util.keystr(path)}"):
            _chex().assert_trees_all_close(x, y, rtol=tolerance, atol=tolerance)


def _chex() -> Any:
    import chex  # here: its tools for tests would be a tenth of the time in which every command starts

    return chex


@contextmanager
def _saying(message: str) -> Iterator[None]:
    """Put what does not hold before what chex says of it."""
    try:
        yield
    except AssertionError as error:
        raise AssertionError(f"{message}: {error}") from None
