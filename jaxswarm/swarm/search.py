"""The compiled program of a search, from a carry to a result; ``minimize`` and its kin call it."""

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.tree_util import keystr, tree_flatten_with_path

from jaxswarm.errors import InputError
from jaxswarm.room import room_for_programs
from jaxswarm.swarm.calling import check_not_varying, check_takes, part_of
from jaxswarm.swarm.in_turn import InTurn
from jaxswarm.swarm.loop import Loop
from jaxswarm.swarm.optimizers.base import Info, as_optimizer, at_least
from jaxswarm.swarm.pytree import as_part, on_device
from jaxswarm.swarm.random import lead_of
from jaxswarm.swarm.repeating import Carry, first, held, repeat_all, repeat_until
from jaxswarm.swarm.result import Result, Status
from jaxswarm.swarm.schedules import for_run
from jaxswarm.swarm.space import Space
from jaxswarm.swarm.standing import outcome
from jaxswarm.swarm.start import Start, begun, points_of
from jaxswarm.swarm.telling import Telling, told

__all__ = [
    "result_of",
    "best_value",
    "check_state",
    "going_on",
    "optimizer_for",
    "rule",
    "runs_of",
    "search",
    "search_one",
    "start_for",
    "the_loop",
]


def best_value(state: Any, info: Info) -> jax.Array:
    """Record the best value so far: what ``minimize`` keeps of each step by default."""
    return info.value_best


@jax.jit
def search(
    loop: Loop, optimizer, space, key, args, stop, start, carry: Carry | None
) -> tuple[Result, Carry]:
    """Make the steps of ``loop`` from a carry, or from the beginning where it is None.

    Args:
      start: None, or ``(points (k, d), spread)``; see ``begin``.
      carry: of a search that goes on; its history is the caller's to join.
    """
    check_not_varying((optimizer, space, key, args, stop, start, carry))
    if carry is None:
        carry = first(loop.map(lambda k: begun(optimizer, k, space, start))(key), stop)
    else:
        check_state(carry.state, loop.map(lambda k: begun(optimizer, k, space, None)), key)
    before = carry.num_steps
    step = partial(loop.advance, optimizer, space, key, args)
    run = repeat_all if stop is None else partial(repeat_until, stop)
    carry, history = run(loop, step, carry)
    if stop is not None:
        history = held(history, carry.num_steps - before, 1 if loop.runs else 0)

    state = carry.state
    code = outcome(state, carry.code)
    result = Result(
        params=loop.map(space.decode)(state.best_position),
        value=state.best_value,
        position=state.best_position,
        status=Status(code.astype(jnp.int32)),
        num_steps=carry.num_steps,
        num_evaluations=carry.num_steps * state.position.shape[-2],
        history=history,
        state=state,
    )
    return result, carry


search_one = InTurn(search)
"""The same for a single run; of many the operations are long, and the compiler's own order is faster."""


def the_loop(
    fn,
    space,
    num_steps,
    *,
    record=None,
    vectorized=False,
    progress=None,
    progress_every=1,
    runs=False,
    noisy=False,
    args_axes=None,
) -> Loop:
    """Check and collect what a search depends on besides numbers; room is made for its program."""
    room_for_programs()
    check_takes(fn, *(("key",) if noisy else ()), "params", "args")
    if record is not None:
        check_takes(record, "state", "info", what="record")
    if progress is not None:
        check_takes(progress, "count", "value", what="progress")
    if not isinstance(space, Space):
        raise InputError(f"space={space!r} must be a Space, e.g. Space(x=(-5.0, 5.0)).")
    return Loop(
        fn=as_part(fn),
        record=as_part(record or best_value),
        num_steps=at_least("num_steps", num_steps, 1, "a search needs a step"),
        vectorized=bool(vectorized),
        progress=None if progress is None else Telling(progress),
        progress_every=at_least(
            "progress_every", progress_every, 1, "progress is told now and then"
        ),
        runs=runs,
        noisy=bool(noisy),
        args_axes=args_axes,
    )


def optimizer_for(optimizer, num_steps, state=None):
    """The optimizer with schedules that end with this call, whatever was done before it."""
    if state is not None and not isinstance(getattr(state, "count", None), jax.Array | np.ndarray):
        raise InputError(
            f"state={state!r} is no state of an optimizer: give state=result.state of an earlier call."
        )
    return for_run(as_optimizer(optimizer), _done(state) + num_steps)


def _done(state):
    """Updates that a state has behind it, a float; of many runs the most."""
    if state is None:
        return 0.0
    if isinstance(state.count, jax.core.Tracer):
        return jnp.max(state.count).astype(float)
    return float(np.max(jax.device_get(state.count)))


def rule(stop):
    """The stop rule as a part of the program."""
    if stop is not None and not callable(stop):
        raise InputError(
            f"stop={stop!r} must be a rule such as target(1e-6), stalled(50) or any_of(...)."
        )
    if stop is None:
        return None
    memory = ("memory",) if hasattr(stop, "start") else ()
    return part_of("stop", stop, "progress", *memory)


def going_on(state, stop):
    """The carry of a search that goes on from a state; None for one that begins."""
    return None if state is None else _first(state, on_device(stop))


_first = jax.jit(first)


def result_of(program, loop, optimizer, space, key, args, stop, start, state) -> Result:
    """The result of a program of :func:`search`, which begins or goes on from a state.

    What the search itself holds is put on the device by name, and what ``progress`` raises arrives as it was.
    """
    carry = going_on(state, stop)
    given = loop, *on_device((optimizer, space)), key, args, *on_device((stop, start)), carry
    return told(loop.progress, program, *given)[0]


def start_for(space, start, state=None):
    """Points and spread of a start, checked on the host; None without one."""
    if start is None:
        return None
    if state is not None:
        raise InputError("start and state are both given: a search that goes on has begun.")
    if isinstance(start, Start):
        return points_of(space, start.params), start.spread
    return points_of(space, start), None


def check_state(state: Any, init: Any, key: jax.Array) -> None:
    """Refuse to go on from a state unlike the one that ``init(key)`` gives, another optimizer's or space's."""
    own = jax.eval_shape(init, key)
    kind, wanted = type(state).__name__, type(own).__name__
    shapes, own_shapes = (
        {keystr(path): jnp.shape(leaf) for path, leaf in tree_flatten_with_path(tree)[0]}
        for tree in (state, own)
    )
    names = sorted(shapes.keys() | own_shapes.keys())
    others = [name for name in names if shapes.get(name) != own_shapes.get(name)]
    if kind == wanted and not others:
        return
    what = f"{kind}, this search has {wanted}"
    if kind == wanted:
        here, there = (of.get(others[0], "missing") for of in (shapes, own_shapes))
        what = f"other: shape of {others[0]} {here}, in this search {there}"
    raise InputError(
        f"state is {what}: go on only with a state of the same optimizer, space and number of runs."
    )


def runs_of(keys: Any) -> int:
    """How many runs keys (runs,) are for.

    Raises:
      InputError: a single key, no keys, rows of them.
    """
    lead = lead_of(keys)
    if len(lead) != 1 or not lead[0]:
        raise InputError(
            f"keys have shape {lead}: give one a run, jax.random.split(key, runs), at least one."
        )
    return lead[0]
