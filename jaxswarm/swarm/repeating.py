"""The two ways to repeat the step of a search, and what is carried from step to step.

A state is carried as :func:`flat` makes it, its fields laid as elementwise steps are fast
(:mod:`~jaxswarm.swarm.lanes`).
"""

from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.swarm.forward import forward_only
from jaxswarm.swarm.lanes import laned
from jaxswarm.swarm.pytree import replace
from jaxswarm.swarm.standing import STEPS_DONE, progress_of
from jaxswarm.swarm.stopping import ask, begin

__all__ = ["Carry", "first", "held", "repeat_all", "repeat_until"]


class Carry(NamedTuple):
    """All a search goes on from; with many runs every leaf has a leading axis of runs.

    Attributes:
      state: of the optimizer.
      since: () int32, updates since the best value last fell.
      memory: of the stop rule.
      done: () bool, whether a rule has ended the search; code: () int32, and why.
      num_steps: () int32, updates done.
    """

    state: Any
    since: jax.Array
    memory: Any
    done: jax.Array
    code: jax.Array
    num_steps: jax.Array


def first(state: Any, stop: Any) -> Carry:
    """The carry of a search that begins, or goes on by itself, at ``state``."""
    zero = jnp.zeros_like(state.count)
    memory = jax.tree.map(
        lambda leaf: jnp.broadcast_to(leaf, (*zero.shape, *jnp.shape(leaf))), begin(stop)
    )
    return Carry(state, zero, memory, zero > 0, zero + STEPS_DONE, zero)


def repeat_all(loop, step, carry: Carry):
    """A fixed number of steps."""

    def body(inside, _):
        state, since = unflat(inside)
        state, info = step(state)
        loop.report(state)
        since = jnp.where(info.improved, 0, since + 1)
        return flat((state, since)), loop.map(loop.record)(state, info)

    start = flat((carry.state, carry.since))
    inside, history = jax.lax.scan(body, start, length=loop.num_steps)
    if loop.runs:
        history = jax.tree.map(lambda h: jnp.moveaxis(h, 0, 1), history)
    state, since = unflat(inside)
    num_steps = carry.num_steps + loop.num_steps
    return carry._replace(state=state, since=since, num_steps=num_steps), history


def repeat_until(stop, loop, step, carry: Carry):
    """Steps until the rule fires; with many runs, those that have stopped are held."""
    axis = 1 if loop.runs else 0
    kept = jax.eval_shape(lambda s: loop.map(loop.record)(*step(s)), carry.state)
    history = jax.tree.map(lambda leaf: _blank(leaf, loop.num_steps, axis), kept)

    def running(inside):
        index, carry, _ = inside
        return (index < loop.num_steps) & ~jnp.all(carry.done)

    def body(inside):
        index, carry, history = inside
        old = unflat(carry)
        state, info = step(old.state)
        loop.report(state)
        entry = loop.map(loop.record)(state, info)
        history = jax.tree.map(
            lambda h, e: jax.lax.dynamic_update_index_in_dim(h, e, index, axis), history, entry
        )
        since = jnp.where(info.improved, 0, old.since + 1)
        progress = loop.map(progress_of)(state, since, info.diversity)
        here, reason, memory = loop.map(partial(ask, stop))(progress, old.memory)
        code = jnp.where(here, reason, old.code)
        new = flat(Carry(state, since, memory, old.done | here, code, old.num_steps + 1))
        return index + 1, jax.tree.map(partial(_hold, old.done), carry, new), history

    start = jnp.int32(0), flat(carry), history
    _, carry, history = forward_only(jax.lax.while_loop(running, body, start))
    return unflat(carry), history


def held(history: Any, num_steps: jax.Array, axis: int) -> Any:
    """Steps not done repeat the last one that was: (..., steps, ...) along ``axis`` (0, or 1 of runs)."""

    def one(leaf, count):
        index = jnp.arange(leaf.shape[0], dtype=jnp.int32)
        return leaf[jnp.minimum(index, jnp.maximum(count, 1) - 1)]

    every = jax.vmap(one) if axis else one
    return jax.tree.map(lambda leaf: every(leaf, num_steps), history)


def flat(carry):
    """Lay the fields that a state names in ``CARRIED_LANED`` as steps are fast over them."""
    return _each(carry, lambda field, part: laned(field))


def unflat(carry):
    """Undo :func:`flat`."""

    def rows(field, part):
        lead, dims = part.best_position.shape[:-1], part.best_position.shape[-1]
        return field.reshape(*lead, -1, dims)

    return _each(carry, rows)


def _each(carry, change):
    def changed(part):
        fields = {name: getattr(part, name) for name in part.CARRIED_LANED}
        return replace(part, **{name: change(field, part) for name, field in fields.items()})

    named = lambda part: hasattr(part, "CARRIED_LANED")  # noqa: E731
    return jax.tree.map(lambda p: changed(p) if named(p) else p, carry, is_leaf=named)


def _hold(done, old, new):
    """Keep the old leaf of runs that are done."""
    if done.ndim == 0:  # a single run leaves the loop at once
        return new
    return jnp.where(done.reshape(done.shape + (1,) * (new.ndim - 1)), old, new)


def _blank(leaf, num_steps, axis):
    return jnp.zeros((*leaf.shape[:axis], num_steps, *leaf.shape[axis:]), leaf.dtype)
