"""The loop: evaluate the candidates, update, record, stop.

    state = optimizer.init(key)
    repeat:  value       = fn(space.decode(state.position), args)
             state, info = optimizer.update(fold(key, state.count), state, value)

Steps are a ``lax.scan``, or a ``lax.while_loop`` if there is a stop rule. The key of a step is
derived from the count and not carried, so a search that goes on from a saved state is the same
search. Many runs are ``jax.vmap`` over keys (or over ``args``, coefficients, bounds);
:func:`minimize_runs` joins the populations of all runs before it calls an objective that evaluates
a whole population at once.

What ``progress`` raises, an interrupt too, ends a search at that step and arrives as it was raised. What had
been found is lost: whoever means to end searches like that goes piece by piece (``state=result.state``).

All of it runs under JAX's strict modes. A transfer guard sees only what is the caller's: keys, and data given
as ``args`` that are not on the device yet.
"""

from collections.abc import Callable
from typing import Any

import jax

from jaxswarm.errors import InputError
from jaxswarm.swarm.batches import batch_of, search_in_batches
from jaxswarm.swarm.calling import check_args
from jaxswarm.swarm.needed import refuse_too_many
from jaxswarm.swarm.optimizers.base import Info
from jaxswarm.swarm.pytree import on_device
from jaxswarm.swarm.result import Result
from jaxswarm.swarm.search import (
    best_value,
    optimizer_for,
    result_of,
    rule,
    runs_of,
    search,
    search_one,
    start_for,
    the_loop,
)
from jaxswarm.swarm.space import Space

__all__ = ["best_value", "minimize", "minimize_runs"]


def minimize(
    fn: Callable[..., jax.Array],
    optimizer: Any,
    space: Space,
    key: jax.Array,
    args: Any = None,
    *,
    num_steps: int,
    start: Any = None,
    stop: Any = None,
    record: Callable[[Any, Info], Any] | None = None,
    vectorized: bool = False,
    noisy: bool = False,
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
      optimizer: such as ``pso()``; schedules without a length of their own end with this call.
      space: names and bounds; its dtype is the dtype of the search.
      key: JAX key; the same key gives the same search.
      args: data handed to ``fn``, any pytree of arrays.
      num_steps: number of updates, an upper limit if there is a stop rule.
      start: where to begin: parameters as ``space.decode`` returns them, a population of these, or
        ``around(params, spread)``: evaluated first, and where the mean of ``cma_es`` begins.
      stop: rule from ``stopping``, e.g. ``any_of(target(1e-6), stalled(50))``, ``search_ended()``. A
        search with one has no reverse mode (``jax.grad``); forward mode goes through.
      record: ``(state, info) -> pytree`` kept for every step; default the best value so far.
      vectorized: whether ``fn`` takes the whole population.
      noisy: whether the objective is random, ``fn(key, params, args)`` with a key for every step and
        candidate (with ``vectorized`` for every step); see :mod:`jaxswarm.swarm.noise`.
      state: where to go on from, e.g. ``result.state`` of an earlier call with the same key.
      progress: called on the host with (updates done, best value) after every ``progress_every``.

    Returns:
      A :class:`Result`. ``num_evaluations`` counts the candidates of this call.

    Raises:
      InputError: an objective of the wrong shape, a wrong state or ``num_steps``, too little memory.

    >>> from jaxswarm.swarm import Space, minimize, pso
    >>> def sphere(params, center):
    ...     return (params["x"] - center) ** 2 + params["y"] ** 2
    >>> space = Space(x=(-5.0, 5.0), y=(-5.0, 5.0))
    >>> result = minimize(sphere, pso(20), space, jax.random.key(0), 2.0, num_steps=100)
    >>> round(float(result.params["x"]), 4), result.status.message, int(result.num_evaluations)
    (2.0, 'all steps done', 2000)
    """
    telling = dict(record=record, progress=progress, progress_every=progress_every)
    loop = the_loop(fn, space, num_steps, vectorized=vectorized, noisy=noisy, **telling)
    optimizer, args = optimizer_for(optimizer, num_steps, state), check_args(args)
    refuse_too_many(optimizer, space, loop.num_steps)
    stop, begin = rule(stop), start_for(space, start, state)
    return result_of(search_one, loop, optimizer, space, key, args, stop, begin, state)


def minimize_runs(
    fn: Callable[..., jax.Array],
    optimizer: Any,
    space: Space,
    keys: jax.Array,
    args: Any = None,
    *,
    num_steps: int,
    start: Any = None,
    stop: Any = None,
    record: Callable[[Any, Info], Any] | None = None,
    vectorized: bool = True,
    noisy: bool = False,
    args_axes: Any = None,
    state: Any = None,
    progress: Callable[[int, Any], None] | None = None,
    progress_every: int = 10,
) -> Result:
    """Minimize from many keys at once, with one call of a vectorized ``fn`` for all runs.

    ``jax.vmap`` of :func:`minimize` would turn the matrix product of a vectorized objective into
    one of rank three, which is many times slower on a CPU; here ``fn`` sees one population of runs
    x n; of as many runs as stay in the cache where all would not, one batch after the other.

    Args:
      fn: objective for a population: ``params`` has a leading axis, the result is one value each;
        without ``vectorized`` for one candidate.
      keys: (runs,) JAX keys, e.g. ``jax.random.split(key, 1000)``.
      args_axes: 0 if every run has data of its own, along the first axis of every array of ``args``;
        a tuple of 0 and None if ``args`` is a tuple of such and of shared data; None if all share
        them. With data of its own every run calls ``fn`` for its own population (by ``vmap``).
      progress: called with (updates done, best values of the runs (runs,)).
      optimizer, space, args, num_steps, start, stop, record, noisy, state, progress_every: as for
        :func:`minimize`; all runs have the same start; with a stop rule a run that has stopped is
        held while the others go on.

    Returns:
      A :class:`Result` with a leading axis of runs; run r equals ``minimize`` with ``keys[r]``, to rounding.

    >>> from jaxswarm.swarm import Space, pso
    >>> space = Space.vector([-5.0] * 3, [5.0] * 3)
    >>> keys = jax.random.split(jax.random.key(0), 4)
    >>> result = minimize_runs(lambda x, _: (x**2).sum(axis=1), pso(20), space, keys, num_steps=50)
    >>> result.value.shape, result.params.shape
    ((4,), (4, 3))
    """
    options = dict(record=record, vectorized=vectorized, noisy=noisy)
    telling = dict(progress=progress, progress_every=progress_every)
    runs, axes = runs_of(keys), axes_of_runs(args, args_axes, keys)
    loop = the_loop(fn, space, num_steps, runs=True, args_axes=axes, **options, **telling)
    optimizer = optimizer_for(optimizer, num_steps, state)
    refuse_too_many(optimizer, space, loop.num_steps, runs)
    stop, begin = rule(stop), start_for(space, start, state)
    # What looks at all runs at once, or gives each its own data, keeps them together.
    if stop is None and state is None and progress is None and axes is None:
        batch = batch_of(optimizer, space.size, space.dtype, runs)
        if batch < runs:
            optimizer, space, begin = on_device((optimizer, space, begin))
            return search_in_batches(loop, optimizer, space, keys, args, begin, batch=batch)
    return result_of(search, loop, optimizer, space, keys, args, stop, begin, state)


def axes_of_runs(args: Any, axes: Any, keys: jax.Array) -> Any:
    """Check that data of their own have as many rows as there are runs; the axes, hashable."""
    check_args(args)
    if isinstance(axes, list):
        axes = tuple(axes)
    if axes is None:
        return None
    if isinstance(axes, tuple) and not (isinstance(args, tuple | list) and len(args) == len(axes)):
        raise InputError(
            f"args_axes={axes!r} names {len(axes)} parts: give args as a tuple of these."
        )
    parts = zip(axes, args, strict=True) if isinstance(axes, tuple) else [(axes, args)]
    for axis, part in parts:
        if axis not in (0, None) or isinstance(axis, bool):
            raise InputError(f"args_axes={axes!r} must be None, 0, or a tuple of these.")
        for leaf in jax.tree.leaves(part) if axis == 0 else ():
            if jax.numpy.shape(leaf)[:1] != keys.shape[:1]:
                raise InputError(
                    f"args holds an array of shape {jax.numpy.shape(leaf)} for {keys.shape[0]} runs: "
                    "with args_axes=0 its first axis is that of the runs."
                )
    return axes
