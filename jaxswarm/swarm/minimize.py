"""The loop: evaluate the candidates, update, record, stop.

    state = optimizer.init(key)
    repeat:  value       = fn(space.decode(state.position), args)
             state, info = optimizer.update(fold(key, state.count), state, value)

Steps are a ``lax.scan``, or a ``lax.while_loop`` if there is a stop rule. The key of a step is
derived from the count and not carried, so a search that goes on from a saved state is the same
search. Many runs are ``jax.vmap`` over keys (or over ``args``, coefficients, bounds);
:func:`minimize_runs` joins the populations of all runs before it calls an objective that evaluates
a whole population at once.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError
from jaxswarm.swarm.loop import Loop, repeat_all, repeat_until
from jaxswarm.swarm.optimizers.base import Info, at_least
from jaxswarm.swarm.pytree import as_part
from jaxswarm.swarm.result import Result, Status
from jaxswarm.swarm.schedules import for_run
from jaxswarm.swarm.space import Space
from jaxswarm.swarm.stopping import NO_FINITE_VALUE

__all__ = ["best_value", "minimize", "minimize_runs"]


def best_value(state: Any, info: Info) -> jax.Array:
    """Record the best value so far: what ``minimize`` keeps of each step by default."""
    return info.value_best


def minimize(
    fn: Callable[[Any, Any], jax.Array],
    optimizer: Any,
    space: Space,
    key: jax.Array,
    args: Any = None,
    *,
    num_steps: int,
    stop: Any = None,
    record: Callable[[Any, Info], Any] | None = None,
    vectorized: bool = False,
    state: Any = None,
    progress: Callable[[int, float], None] | None = None,
    progress_every: int = 10,
) -> Result:
    """Minimize ``fn(params, args)`` over a space.

    Args:
      fn: objective for one candidate, returning a scalar; with ``vectorized``, for a whole
        population: ``params`` has a leading axis n and the result is (n,). NaN counts as +inf. A
        function that is the same object as in an earlier call is not compiled again, so pass data
        as ``args``.
      optimizer: from a factory such as ``pso()``, or anything with ``init`` and ``update``. Schedules
        without a length of their own end with this call.
      space: names and bounds; its dtype is the dtype of the search.
      key: JAX key; the same key gives the same search.
      args: data handed to ``fn``, any pytree of arrays.
      num_steps: number of updates, an upper limit if there is a stop rule.
      stop: rule from ``stopping``, e.g. ``any_of(target(1e-6), stalled(50))``.
      record: ``(state, info) -> pytree`` kept for every step; default the best value so far.
      vectorized: whether ``fn`` takes the whole population.
      state: where to go on from, e.g. ``result.state`` of an earlier call with the same key.
      progress: called on the host with (updates done, best value) every ``progress_every`` updates;
        absent from the compiled program if None.
      progress_every: updates between two calls of ``progress``.

    Returns:
      A :class:`Result`. ``num_evaluations`` counts the candidates of this call.

    Raises:
      InputError: an objective of the wrong shape, ``num_steps`` below 1, a state of another size.

    >>> from jaxswarm.swarm import Space, minimize, pso
    >>> def sphere(params, center):
    ...     return (params["x"] - center) ** 2 + params["y"] ** 2
    >>> space = Space(x=(-5.0, 5.0), y=(-5.0, 5.0))
    >>> result = minimize(sphere, pso(20), space, jax.random.key(0), 2.0, num_steps=100)
    >>> round(float(result.params["x"]), 4), result.status.message, int(result.num_evaluations)
    (2.0, 'all steps done', 2000)
    """
    loop = _loop(fn, num_steps, record, vectorized, progress, progress_every, runs=False)
    optimizer = _of_length(optimizer, num_steps, state)
    return _minimize(loop, optimizer, space, key, args, _stop(stop), state)


def minimize_runs(
    fn: Callable[[Any, Any], jax.Array],
    optimizer: Any,
    space: Space,
    keys: jax.Array,
    args: Any = None,
    *,
    num_steps: int,
    stop: Any = None,
    record: Callable[[Any, Info], Any] | None = None,
    state: Any = None,
) -> Result:
    """Minimize from many keys at once, with one call of a vectorized ``fn`` for all runs.

    ``jax.vmap`` of :func:`minimize` would turn the matrix product of a vectorized objective into
    one of rank three, which is many times slower on a CPU; here ``fn`` sees one population of runs
    x n.

    Args:
      fn: objective for a population: ``params`` has a leading axis, the result is one value each.
      keys: (runs,) JAX keys, e.g. ``jax.random.split(key, 1000)``.
      optimizer, space, args, num_steps, stop, record, state: as for :func:`minimize`; with a stop
        rule a run that has stopped is held while the others go on.

    Returns:
      A :class:`Result` with a leading axis of runs; run r equals ``minimize`` with ``keys[r]``.

    >>> from jaxswarm.swarm import Space, pso
    >>> space = Space.vector([-5.0] * 3, [5.0] * 3)
    >>> keys = jax.random.split(jax.random.key(0), 4)
    >>> result = minimize_runs(lambda x, _: (x**2).sum(axis=1), pso(20), space, keys, num_steps=50)
    >>> result.value.shape, result.params.shape
    ((4,), (4, 3))
    """
    loop = _loop(fn, num_steps, record, True, None, 1, runs=True)
    optimizer = _of_length(optimizer, num_steps, state)
    return _minimize(loop, optimizer, space, keys, args, _stop(stop), state)


@jax.jit
def _minimize(loop: Loop, optimizer, space, key, args, stop, state) -> Result:
    if state is None:
        state = loop.map(lambda k: optimizer.init(k, space.size, dtype=space.dtype))(key)
    _check_state(state, space, loop.runs)
    start = (state, jnp.zeros_like(state.count))
    step = partial(loop.advance, optimizer, space, key, args)
    run = repeat_all if stop is None else partial(repeat_until, stop)
    (state, _), num_steps, code, history = run(loop, step, start)

    code = jnp.where(state.best_value < jnp.inf, code, NO_FINITE_VALUE)
    return Result(
        params=loop.map(space.decode)(state.best_position),
        value=state.best_value,
        position=state.best_position,
        status=Status(code.astype(jnp.int32)),
        num_steps=num_steps,
        num_evaluations=num_steps * state.position.shape[-2],
        history=history,
        state=state,
    )


def _loop(fn, num_steps, record, vectorized, progress, progress_every, runs) -> Loop:
    if not callable(fn):
        raise InputError(f"fn={fn!r} must be a function of (params, args).")
    return Loop(
        fn=as_part(fn),
        record=as_part(record or best_value),
        num_steps=at_least("num_steps", num_steps, 1, "a search needs a step"),
        vectorized=vectorized,
        progress=progress,
        progress_every=at_least(
            "progress_every", progress_every, 1, "progress is told now and then"
        ),
        runs=runs,
    )


def _of_length(optimizer, num_steps, state):
    """Schedules without a length end with this call, whatever was done before it."""
    done = 0.0 if state is None else jnp.max(state.count).astype(float)
    return for_run(optimizer, done + num_steps)


def _stop(stop):
    if stop is not None and not callable(stop):
        raise InputError(
            f"stop={stop!r} must be a rule such as target(1e-6), stalled(50) or any_of(...)."
        )
    return None if stop is None else as_part(stop)


def _check_state(state, space, runs):
    rank = 3 if runs else 2
    if state.position.ndim != rank or state.position.shape[-1] != space.size:
        raise InputError(
            f"state.position has shape {state.position.shape}, the space has {space.size} "
            "coordinates: go on only with a state of the same optimizer and space."
        )
