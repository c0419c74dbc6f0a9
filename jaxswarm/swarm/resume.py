"""Resume: a search that is interrupted goes on, in any process, as if it had not been.

Keys are derived from the count of updates, so what is carried from step to step is all there is: the
state, what the stop rule looks back on, and for many runs which of them have ended. Schedules know the
whole run from the start. What a checkpoint belongs to is compared by value: the parts and numbers of the
optimizer and the stop rule, bounds and scales, the key, the start, and the objective by its name and by
what it says of three points of the cube.
"""

import dataclasses
import os
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.nodes import node
from jaxswarm.swarm.checkpoint import header_of, restore, save
from jaxswarm.swarm.fingerprint import fingerprint
from jaxswarm.swarm.loop import Loop
from jaxswarm.swarm.minimize import axes_of_runs
from jaxswarm.swarm.needed import refuse_too_many
from jaxswarm.swarm.optimizers.base import at_least
from jaxswarm.swarm.pytree import on_device, replace
from jaxswarm.swarm.random import lead_of
from jaxswarm.swarm.repeating import held
from jaxswarm.swarm.result import Result
from jaxswarm.swarm.search import optimizer_for, rule, runs_of, search, start_for, the_loop
from jaxswarm.swarm.space import Space
from jaxswarm.swarm.standing import STEPS_DONE, TIME_UP
from jaxswarm.swarm.stopping import renewed

__all__ = ["minimize_resumable"]

PROBES = (0.5, 0.25, 0.8)
"""Points of the cube, all coordinates alike, at which an objective is asked who it is."""
PROBE_DIGITS = {8: 9, 4: 4}
"""Digits that are compared of a value, by its bytes: two machines differ in those behind."""


def minimize_resumable(
    fn: Callable[..., jax.Array],
    optimizer: Any,
    space: Space,
    key: jax.Array,
    args: Any = None,
    *,
    num_steps: int,
    path: str | os.PathLike,
    every: int = 100,
    start: Any = None,
    stop: Any = None,
    vectorized: bool = False,
    noisy: bool = False,
    args_axes: Any = None,
    record: Any = None,
) -> Result:
    """Minimize with a checkpoint every ``every`` steps; the same call goes on after a break.

    The result is bit for bit that of the uninterrupted call, and its history covers all steps. A
    ``time_limit`` counts anew in every call.

    Args:
      key: one JAX key, or (runs,) keys for as many runs side by side (as ``minimize_runs``).
      path: the checkpoint; made if missing, gone on from if present. A finished search is returned
        from it without a step.
      every: updates between two checkpoints.
      fn, optimizer, space, args, num_steps, start, stop, vectorized, noisy, args_axes, record: as for
        ``minimize_runs``; data are not stored, so give the same ones again.

    Raises:
      InputError: the checkpoint belongs to another optimizer, space, key, objective, stop rule or
        number of steps. A search goes on beyond the ``num_steps`` it was begun with only if its
        schedules have lengths of their own: those that last as long as the run would have been
        others from the start. Or too little memory.
    """
    at_least("every", every, 1, "a checkpoint follows a step")
    if not Path(path).parent.is_dir():
        raise InputError(
            f"path={str(path)!r}: there is no folder {Path(path).parent}; make it first."
        )
    runs = bool(lead_of(key)) and runs_of(key) > 0
    axes = axes_of_runs(args, args_axes, key) if runs else None
    options = dict(record=record, vectorized=vectorized, noisy=noisy, runs=runs, args_axes=axes)
    loop = the_loop(fn, space, num_steps, **options)
    # Once, for all pieces: a schedule that lasts as long as the run must know the whole of it.
    optimizer = optimizer_for(optimizer, num_steps)
    refuse_too_many(optimizer, space, loop.num_steps, key.shape[0] if runs else 1)
    stop, begin = rule(stop), start_for(space, start)
    header = _header(loop, fn, optimizer, space, key, args, stop, begin)
    rest = (*on_device((optimizer, space)), key, args, *on_device((stop, begin)))
    done, result, carry = _kept(path, loop, rest, header)
    while done < loop.num_steps and not (carry is not None and np.all(jax.device_get(carry.done))):
        size = min(every, loop.num_steps - done)
        new, carry = search(replace(loop, num_steps=size), *rest, carry)
        result = new if result is None else _joined(result, new, runs)
        done += size
        save(path, (result, carry), steps=done, **header)
    result = dataclasses.replace(result, history=jax.tree.map(jax.device_put, result.history))
    return result if stop is None else _whole(result, carry, loop)


def _kept(path, loop, rest, header) -> tuple[int, Any, Any]:
    """Steps done, result and carry of the checkpoint; without one there is nothing of it."""
    if not Path(path).exists():
        return 0, None, None
    # The prototype's history grows with the steps done, which only the file knows.
    done = min(_steps_done(path), loop.num_steps)
    return done, *_restored(path, loop, rest, done, header)


def _restored(path, loop, rest, done, header):
    like = jax.eval_shape(lambda *given: search(replace(loop, num_steps=done), *given), *rest, None)
    result, carry = restore(path, like, steps=done, **header)
    stop = rest[4]
    if stop is None:
        return result, carry
    return result, _reopened(stop, carry)


@jax.jit
def _reopened(stop, carry):
    """A clock of another process says nothing here: what it ended goes on."""
    late = carry.done & (carry.code == TIME_UP)
    code = jnp.where(late, STEPS_DONE, carry.code)
    memory = renewed(stop, carry.memory)
    return carry._replace(done=carry.done & ~late, code=code, memory=memory)


def _joined(old: Result, new: Result, runs: bool) -> Result:
    """The newer result with the history of both; on the host, where a longer one is no other program."""
    axis = 1 if runs else 0
    parts = jax.device_get((old.history, new.history))
    history = jax.tree.map(lambda a, b: np.concatenate([a, b], axis), *parts)
    return dataclasses.replace(new, history=history)


def _whole(result: Result, carry, loop: Loop) -> Result:
    """The result with a history of all steps: what was not done repeats the last step that was."""
    axis = 1 if loop.runs else 0
    history = _padded(result.history, carry.num_steps, loop.num_steps, axis)
    return dataclasses.replace(result, history=history)


@partial(jax.jit, static_argnames=("length", "axis"))
def _padded(history, num_steps, length, axis):
    def pad(leaf):
        missing = length - leaf.shape[axis]
        return jnp.pad(leaf, [(0, missing if i == axis else 0) for i in range(leaf.ndim)])

    return held(jax.tree.map(pad, history), num_steps, axis)


def _header(loop, fn, optimizer, space, key, args, stop, begin) -> dict[str, Any]:
    return dict(
        optimizer=fingerprint(optimizer),
        space=[
            list(space.names),
            *(np.asarray(end).tolist() for end in (space.lower, space.upper)),
        ],
        scales=list(space.scales),
        key=_key_words(key),
        start=fingerprint(begin),
        stop=fingerprint(stop),
        objective=[
            getattr(fn, "__qualname__", type(fn).__name__),
            _probe(loop, optimizer, space, key, args),
        ],
    )


def _probe(loop, optimizer, space, key, args) -> list:
    """What the objective says of three points, in digits that do not depend on the machine."""
    lead = key.shape[:1] if loop.runs else ()
    at = np.broadcast_to(np.array(PROBES)[:, None], (*lead, len(PROBES), space.size))
    state = _Asked(jax.device_put(at.astype(space.dtype)), jax.device_put(np.zeros(lead, np.int32)))
    optimizer, space = on_device((optimizer, space))
    value = jax.device_get(jax.jit(loop.evaluate)(optimizer, space, key, state, args))
    digits = PROBE_DIGITS[value.dtype.itemsize]
    return [f"{number:.{digits}g}" for number in value.ravel()]


@node
@dataclasses.dataclass(frozen=True)
class _Asked:
    position: jax.Array
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


def _steps_done(path) -> int:
    header = header_of(path)
    if not isinstance(header.get("steps"), int):
        raise InputError(f"{path} is no checkpoint of a search: it does not say how far it came.")
    return header["steps"]


def _key_words(key: jax.Array) -> list:
    typed = jnp.issubdtype(key.dtype, jax.dtypes.prng_key)
    return jax.device_get(jax.random.key_data(key) if typed else key).tolist()
