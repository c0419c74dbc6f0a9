"""The step of a search: evaluate the candidates, update, report; ``repeating`` repeats it."""

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError
from jaxswarm.swarm.calling import called
from jaxswarm.swarm.optimizers.base import Info, comparable, num_values, once
from jaxswarm.swarm.pytree import pytree, static
from jaxswarm.swarm.random import fold

__all__ = ["Loop"]

EVALUATION = 0x0B1EC
"""What is folded into the key of a step for the objective: other numbers than the optimizer's."""


@pytree
class Loop:
    """The choices that the compiled program of a search depends on.

    Attributes:
      fn: the objective; record: what is kept of a step.
      runs: whether there is a leading axis of runs; args_axes: the axis of the runs in each of
        ``args`` (a prefix of them), None where all share the data.
      noisy: whether ``fn`` takes a key first.
    """

    fn: Any
    record: Any
    num_steps: int = static()
    vectorized: bool = static()
    progress: Any = static()
    progress_every: int = static()
    runs: bool = static()
    noisy: bool = static()
    args_axes: Any = static()

    def advance(self, optimizer, space, key, args, state):
        """One step: the next state, and what an observer may want of it."""
        value = self.evaluate(optimizer, space, key, state, args)

        def update(k, s, v):
            new, info = optimizer.update(fold(k, s.count), s, v)
            _check_info(info)
            return new, info

        return self.map(update)(key, state, value)

    def evaluate(self, optimizer, space, key, state, args):
        """Values of the candidates: (n,) for (n, d), or (runs, n) for (runs, n, d).

        For an optimizer with ``num_values`` there are as many numbers a candidate, (..., n, k).
        """
        width = num_values(optimizer)
        single = partial(self._population, space, width)
        if not self.runs:
            return single(args, state.position, _keys(key, state.count) if self.noisy else None)
        if not self.noisy and self.args_axes is None:
            # One population of all runs: one matrix product, not one of rank three.
            joined = state.position.reshape(-1, state.position.shape[-1])
            value = single(args, joined, None)
            return value.reshape(state.position.shape[:-1] + value.shape[1:])
        keys = jax.vmap(_keys)(key, state.count) if self.noisy else None
        axes = self.args_axes, 0, 0 if self.noisy else None
        return jax.vmap(single, in_axes=axes)(args, state.position, keys)

    def _population(self, space, width, args, position, key):
        given = () if key is None else (key,)
        if self.vectorized:
            decode = lambda: jax.vmap(space.decode)(position)  # noqa: E731
            # Reductions of many rows are slow to compute what is fused into them.
            params = once(decode) if self.runs and self.args_axes is None else decode()
            value = called(self.fn, (*given, params, args), position.shape[:1], width, True)
        elif key is None:
            value = jax.vmap(lambda x: self._one(space, width, x, args))(position)
        else:
            keys = jax.vmap(partial(fold, key))(jnp.arange(position.shape[0]))
            value = jax.vmap(lambda k, x: self._one(space, width, x, args, k))(keys, position)
        return comparable(value, position.dtype)

    def _one(self, space, width, x, args, *key):
        return called(self.fn, (*key, space.decode(x), args), (), width, False)

    def map(self, function):
        """Map over the runs, if there are runs."""
        return jax.vmap(function) if self.runs else function

    def report(self, state):
        """Call the host now and then; nothing at all without a progress function."""
        if self.progress is None:
            return
        count = jnp.max(state.count)  # of runs with a stop rule, those that go on have the most
        call = partial(jax.debug.callback, self.progress)
        due = count % self.progress_every == 0
        jax.lax.cond(due, lambda c, v: call(c, v), lambda c, v: None, count, state.best_value)


def _keys(key, count):
    return fold(fold(key, count), EVALUATION)


def _check_info(info):
    missing = [name for name in Info._fields if not hasattr(info, name)]
    if missing:
        raise InputError(
            f"update returned info={info!r}, which has no {', '.join(missing)}: return (state, Info), "
            "e.g. with candidate_info(position, value, best_value, improved, {})."
        )
