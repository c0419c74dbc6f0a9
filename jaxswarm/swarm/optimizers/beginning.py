"""A search that begins where its user wants: candidates of the first step that are given.

Of the first candidates as many rows as there are points become the points; with a spread the others
lie normally around them, else they stay where the optimizer drew them. A search whose candidates come
from a normal distribution (a state, or a part of one, with ``mean`` and ``sigma`` (), or ``mean`` and
``spread`` (d,)) has its mean moved to the mean of the points, and its candidates with it. An optimizer
that wraps another passes the points on in a method ``begin(key, state, points, spread)``.
"""

from typing import Any

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError
from jaxswarm.swarm.optimizers.boundaries import reflect
from jaxswarm.swarm.pytree import replace
from jaxswarm.swarm.random import Random

__all__ = ["begin"]


def begin(optimizer: Any, key: jax.Array, state: Any, points: jax.Array, spread: Any) -> Any:
    """Return the first state of a search with given candidates in it.

    Args:
      optimizer: the optimizer that made ``state``.
      key: JAX key.
      state: what ``optimizer.init`` returned.
      points: (k, d) of the unit cube, k at most the number of candidates.
      spread: standard deviation of the other candidates around the points in units of the cube; None
        to leave them, and the first step size of a distribution, as they are.

    >>> from jaxswarm.swarm import pso
    >>> key, optimizer = jax.random.key(0), pso(5)
    >>> state = begin(optimizer, key, optimizer.init(key, 2), jnp.array([[0.25, 0.5]]), 0.01)
    >>> bool((abs(state.position - jnp.array([0.25, 0.5])) < 0.1).all())
    True
    """
    if hasattr(optimizer, "begin"):
        return optimizer.begin(key, state, points, spread)
    (n, _), k = state.position.shape, points.shape[0]
    if k > n:
        raise InputError(
            f"start holds {k} points, the optimizer has {n} candidates: give at most {n}."
        )
    points = points.astype(state.position.dtype)
    position, drawn = state.position, _drawn_from(state)
    if drawn is not None:
        state, position = _moved(state, drawn, points, spread)
    elif spread is not None:
        noise = Random(key).normal("start", position.shape, position.dtype)
        position = _folded(points[jnp.arange(n) % k] + jnp.asarray(spread, position.dtype) * noise)
    position = position.at[:k].set(points)
    return replace(state, position=position, best_position=position[0])


def _drawn_from(state):
    """The part of a state that holds a distribution, as a path of names; None without one."""
    if not hasattr(state, "_fields"):
        return None
    if hasattr(state, "mean") and _width(state):
        return ()
    for name in state._fields:
        path = _drawn_from(getattr(state, name))
        if path is not None:
            return (name, *path)
    return None


def _width(part):
    """Name of the field that holds the size of a distribution; empty without one."""
    return next((name for name in ("sigma", "spread") if hasattr(part, name)), "")


def _moved(state, path, points, spread):
    part = state
    for name in path:
        part = getattr(part, name)
    width = getattr(part, _width(part))
    mean, new = points.mean(axis=0), width
    if spread is not None:
        new = jnp.full_like(width, spread)
    elif points.shape[0] > 1:
        apart = jnp.sqrt(jnp.mean((points - mean[None]) ** 2)).astype(width.dtype)
        new = jnp.where(apart > 0.0, apart, width)
    drawn = state.sample if hasattr(state, "sample") else state.position
    # One width, or one a coordinate: as a row.
    sample = mean[None] + (drawn - part.mean[None]) * jnp.reshape(new / width, (1, -1))
    if hasattr(state, "sample"):
        state = state._replace(sample=sample)
    return _put(state, path, part._replace(**{"mean": mean, _width(part): new})), _folded(sample)


def _put(state, path, part):
    """``state`` with ``part`` at the end of a path of names."""
    if not path:
        return part._replace(sample=state.sample) if hasattr(part, "sample") else part
    return state._replace(**{path[0]: _put(getattr(state, path[0]), path[1:], part)})


def _folded(position):
    """Folded into the cube like light between mirrors."""
    return reflect(1.0)(None, position, jnp.zeros_like(position))[0]
