r"""Objectives that are random: values judged again, and what to recommend in the end.

The best value of a noisy objective is the luckiest, not the best one, and a swarm that remembers it
follows it for ever. :func:`reevaluate` wraps an optimizer with a memory (particle swarms, differential
evolution, genetic algorithms): every remembered candidate is evaluated again in every step, and its
value is the mean of all its evaluations,

    m_k = m_{k-1} + (v_k - m_{k-1}) / k,

so that luck fades with 1 / sqrt(k) as long as a candidate stays. That costs as many evaluations more as
there are memories. :func:`averaged` spends them on every candidate alike. A distribution needs neither:
``cma_es`` averages over its parents, and its mean is the recommendation (:func:`recommend`).

References:
    Y. Jin, J. Branke, "Evolutionary optimization in uncertain environments: a survey", IEEE Trans.
    Evol. Comput. 9 (2005), doi 10.1109/TEVC.2005.846356 (explicit averaging, reevaluation); N. Hansen et
    al., "A method for handling uncertainty in evolutionary optimization", IEEE Trans. Evol. Comput. 13
    (2009), doi 10.1109/TEVC.2008.924423 (recombination as implicit averaging).
"""

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError
from jaxswarm.swarm.optimizers.base import as_optimizer, at_least, comparable
from jaxswarm.swarm.optimizers.beginning import begin
from jaxswarm.swarm.optimizers.boundaries import reflect
from jaxswarm.swarm.optimizers.remembered import require_memory, same_rows
from jaxswarm.swarm.pytree import as_part, on_device, pytree, replace, static
from jaxswarm.swarm.random import fold

__all__ = ["averaged", "recommend", "reevaluate"]

ENOUGH = 0.5
"""Share of the evaluations of the memory that was evaluated most, from which on one is recommended."""


class ReevaluateState(NamedTuple):
    """Candidates, the memories behind them (n + m, d), and how often each memory was evaluated (m,)."""

    inner: Any
    position: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    seen: jax.Array
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


@pytree
class Reevaluate:
    """See :func:`reevaluate`."""

    inner: Any

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> ReevaluateState:
        """The candidates of the wrapped optimizer twice: nothing is remembered yet."""
        inner = self.inner.init(fold(key, 1), num_dims, dtype=dtype)
        require_memory(inner, "reevaluate")
        seen = jnp.zeros(getattr(inner, inner.MEMORY[1]).shape, inner.position.dtype)
        return _joined(inner, seen, jnp.zeros((), jnp.int32))

    def begin(self, key: jax.Array, state: ReevaluateState, points: jax.Array, spread: Any):
        """The wrapped optimizer begins at the points."""
        return _joined(begin(self.inner, key, state.inner, points, spread), state.seen, state.count)

    def update(self, key: jax.Array, state: ReevaluateState, value: jax.Array):
        """Average the memories, update what is wrapped, and look which memories stayed."""
        value = comparable(value, state.position)
        inner, n = state.inner, state.inner.position.shape[0]
        places, values = inner.MEMORY
        known, mean = getattr(inner, places), getattr(inner, values)
        seen = state.seen + 1.0
        # +inf stays: a candidate that failed once may fail again. Before the first step all have it.
        mean = jnp.where(jnp.isfinite(mean), mean + (value[n:] - mean) / seen, mean)
        leader = jnp.argmin(mean)
        # A search that began anew has forgotten its best candidate: what is known of it stands.
        forgotten = ~jnp.all(known == inner.best_position[None], axis=1).any()
        stands = (forgotten & (inner.best_value < mean[leader])) | (mean[leader] == jnp.inf)
        inner = replace(
            inner,
            position=state.position[:n],
            **{values: mean},
            best_position=jnp.where(stands, inner.best_position, known[leader]),
            best_value=jnp.where(stands, inner.best_value, mean[leader]),
        )
        inner, info = self.inner.update(fold(key, 1), inner, value[:n])
        row, stayed = same_rows(known, getattr(inner, places))
        seen = jnp.where(stayed, seen[row], 1.0)
        new = _joined(inner, seen, state.count + 1)
        return new, info._replace(improved=new.best_value < state.best_value)


def _joined(inner, seen, count):
    position = jnp.concatenate([inner.position, getattr(inner, inner.MEMORY[0])])
    return ReevaluateState(inner, position, inner.best_position, inner.best_value, seen, count)


def reevaluate(inner: Any) -> Reevaluate:
    """Wrap an optimizer that remembers candidates, so that it evaluates them again in every step.

    The best value is the lowest mean, which may rise when luck wears off. On an objective without noise
    the search is that of ``inner``, at twice the evaluations.

    Args:
      inner: an optimizer with a memory of its own; wrap other wrappers around, not inside.

    >>> from jaxswarm.swarm import pso
    >>> reevaluate(pso(5)).init(jax.random.key(0), 2).position.shape
    (10, 2)
    """
    return Reevaluate(as_optimizer(inner))


@pytree
class Averaged:
    """See :func:`averaged`."""

    fn: Any
    num: int = static()

    def __call__(self, key, params, args):
        keys = jax.vmap(partial(fold, key))(jnp.arange(self.num, dtype=jnp.int32))
        return jnp.mean(jax.vmap(lambda k: self.fn(k, params, args))(keys), axis=0)


def averaged(fn: Callable[[jax.Array, Any, Any], jax.Array], num: int) -> Averaged:
    """Return an objective that is the mean of ``num`` evaluations with keys of their own.

    Args:
      fn: random objective ``fn(key, params, args)``, of one candidate or, vectorized, of many.
      num: evaluations; the noise shrinks by their square root.

    >>> noisy = lambda key, x, args: x + jax.random.normal(key)
    >>> abs(float(averaged(noisy, 400)(jax.random.key(0), 0.0, None))) < 0.2
    True
    """
    return Averaged(as_part(fn), at_least("num", num, 1, "a mean is of something"))


def recommend(result: Any, space: Any) -> Any:
    """Return the parameters to use after a search under noise, as ``space.decode`` does.

    The mean of the distribution for one that has a mean (``cma_es``; of a restarted one unless the present
    life is young; not within ``restart``). Under
    :func:`reevaluate` the lowest mean among the memories that were evaluated at least half as often as
    any: a new one may be the luckiest still. Else the best position.

    Args:
      result: a ``Result`` of one run, or its final state.
      space: the space of the search.
    """
    return _recommended(getattr(result, "state", result), on_device(space))


@jax.jit
def _recommended(state, space):
    if isinstance(state, ReevaluateState):
        places, values = (getattr(state.inner, name) for name in state.inner.MEMORY)
        proven = state.seen >= ENOUGH * state.seen.max()
        return space.decode(places[jnp.argmin(jnp.where(proven, values, jnp.inf))])
    mean = _mean_of(state)
    if mean is None:
        return space.decode(state.best_position)
    if mean.shape != (space.size,):
        raise InputError(
            f"the state holds a mean of shape {mean.shape} for {space.size} coordinates: recommend "
            "one run and one population over all coordinates."
        )
    return space.decode(reflect(1.0)(None, mean, jnp.zeros_like(mean))[0])


def _mean_of(state):
    if hasattr(state, "_fields") and hasattr(state, "mean"):
        return state.mean
    if not hasattr(state, "_fields") or hasattr(state, "restarts"):
        return None  # an array; or a search whose present life may just have begun
    for part in state:
        mean = _mean_of(part)
        if mean is not None:
            return mean
    return None
