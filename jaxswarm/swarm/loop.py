"""The step of a search and the two ways to repeat it; what ``minimize`` compiles.

From step to step a state is carried as :func:`flat` makes it. XLA on a CPU runs the loops of an
elementwise step along the last axis of its result; over rows of a dozen coordinates it unrolls them
and gathers lane by lane, which took two to three times as long as one pass over a flat array.
"""

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError
from jaxswarm.swarm.optimizers.base import comparable, once
from jaxswarm.swarm.pytree import pytree, replace, static
from jaxswarm.swarm.random import fold
from jaxswarm.swarm.stopping import STEPS_DONE, Progress

__all__ = ["Loop", "repeat_all", "repeat_until"]


@pytree
class Loop:
    """The choices that the compiled program of a search depends on."""

    fn: Any
    record: Any
    num_steps: int = static()
    vectorized: bool = static()
    progress: Any = static()
    progress_every: int = static()
    runs: bool = static()

    def advance(self, optimizer, space, key, args, carry):
        """One step: evaluate, update, count."""
        state, since = carry
        value = self.evaluate(space, state.position, args)
        update = self.map(lambda k, s, v: optimizer.update(fold(k, s.count), s, v))
        state, info = update(key, state, value)
        since = jnp.where(info.improved, 0, since + 1)
        return (state, since), info

    def evaluate(self, space, position, args):
        """Values of the candidates: (n,) for (n, d), or (runs, n) for (runs, n, d)."""
        flat = position.reshape(-1, position.shape[-1])
        if self.vectorized:
            decode = lambda: jax.vmap(space.decode)(flat)  # noqa: E731
            # Reductions of many rows are slow to compute what is fused into them.
            value = self.fn(once(decode) if self.runs else decode(), args)
            _check_shape(value, flat.shape[:1], True)
        else:
            value = jax.vmap(lambda x: self._one(space, x, args))(flat)
        return comparable(value, position.dtype).reshape(position.shape[:-1])

    def _one(self, space, x, args):
        value = self.fn(space.decode(x), args)
        _check_shape(value, (), False)
        return value

    def map(self, function):
        """Map over the runs, if there are runs."""
        return jax.vmap(function) if self.runs else function

    def report(self, state):
        """Call the host now and then; nothing at all without a progress function."""
        if self.progress is None:
            return
        due = state.count % self.progress_every == 0
        call = partial(jax.debug.callback, self.progress)
        jax.lax.cond(due, lambda s: call(s.count, s.best_value), lambda s: None, state)


def repeat_all(loop, step, start):
    """A fixed number of steps."""

    def body(carry, _):
        carry, info = step(unflat(carry))
        loop.report(carry[0])
        return flat(carry), loop.map(loop.record)(carry[0], info)

    carry, history = jax.lax.scan(body, flat(start), length=loop.num_steps)
    if loop.runs:
        history = jax.tree.map(lambda h: jnp.moveaxis(h, 0, 1), history)
    num_steps = jnp.full_like(carry[1], loop.num_steps)
    return unflat(carry), num_steps, jnp.full_like(num_steps, STEPS_DONE), history


def repeat_until(stop, loop, step, start):
    """Steps until the rule fires; with many runs, those that have stopped are held."""
    axis = 1 if loop.runs else 0
    kept = jax.eval_shape(lambda c: loop.map(loop.record)(step(c)[0][0], step(c)[1]), start)
    history = jax.tree.map(lambda leaf: _blank(leaf, loop.num_steps, axis), kept)
    zero = jnp.zeros_like(start[1])

    def running(loop_state):
        index, _, done, *_ = loop_state
        return (index < loop.num_steps) & ~jnp.all(done)

    def body(loop_state):
        index, carry, done, code, num_steps, history = loop_state
        new, info = step(unflat(carry))
        loop.report(new[0])
        entry = loop.map(loop.record)(new[0], info)
        carry = jax.tree.map(partial(_hold, done), carry, flat(new))
        entry = jax.tree.map(
            lambda e, h: _hold(done, jnp.take(h, index, axis=axis), e), entry, history
        )
        history = jax.tree.map(
            lambda h, e: jax.lax.dynamic_update_index_in_dim(h, e, index, axis), history, entry
        )
        state, since = carry
        here, reason = loop.map(stop)(
            Progress(state.count, state.best_value, since, info.diversity)
        )
        code = jnp.where(here & ~done, reason, code)
        return index + 1, carry, done | here, code, num_steps + ~done, history

    first = (jnp.int32(0), flat(start), zero > 0, zero + STEPS_DONE, zero, history)
    _, carry, _, code, num_steps, history = jax.lax.while_loop(running, body, first)
    return unflat(carry), num_steps, code, history


def flat(carry):
    """Join the last two axes of the fields that a state names in ``CARRIED_FLAT``."""
    return _reshape(carry, lambda lead, dims: (*lead, -1))


def unflat(carry):
    """Undo :func:`flat`."""
    return _reshape(carry, lambda lead, dims: (*lead, -1, dims))


def _reshape(carry, shape):
    def reshape(part):
        to = shape(part.best_position.shape[:-1], part.best_position.shape[-1])
        return replace(
            part, **{name: getattr(part, name).reshape(to) for name in part.CARRIED_FLAT}
        )

    named = lambda part: hasattr(part, "CARRIED_FLAT")  # noqa: E731
    return jax.tree.map(lambda p: reshape(p) if named(p) else p, carry, is_leaf=named)


def _hold(done, old, new):
    """Keep the old leaf of runs that are done."""
    if done.ndim == 0:  # a single run leaves the loop at once
        return new
    return jnp.where(done.reshape(done.shape + (1,) * (new.ndim - 1)), old, new)


def _blank(leaf, num_steps, axis):
    shape = (*leaf.shape[:axis], num_steps, *leaf.shape[axis:])
    fill = jnp.nan if jnp.issubdtype(leaf.dtype, jnp.inexact) else 0
    return jnp.full(shape, fill, leaf.dtype)


def _check_shape(value, expected, vectorized):
    shape = jnp.shape(value)
    if shape == expected:
        return
    if vectorized:
        raise InputError(
            f"fn returned shape {shape} for a population, expected {expected}: with "
            "vectorized=True it must return one value a candidate."
        )
    raise InputError(
        f"fn returned shape {shape}, expected a scalar: fn(params, args) gets one candidate; "
        "if yours evaluates the whole population, pass vectorized=True."
    )
