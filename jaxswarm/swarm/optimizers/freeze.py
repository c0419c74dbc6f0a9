"""Freeze: hold some coordinates fixed and let the wrapped optimizer search the others."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.swarm.optimizers.base import as_optimizer, dimensions
from jaxswarm.swarm.optimizers.beginning import begin
from jaxswarm.swarm.pytree import pytree, replace, static
from jaxswarm.swarm.random import fold

__all__ = ["Freeze", "FreezeState", "freeze"]


class FreezeState(NamedTuple):
    """State of the wrapped optimizer over the free coordinates; candidates over all."""

    inner: Any
    position: jax.Array
    best_position: jax.Array
    best_value: jax.Array
    count: jax.Array  # type: ignore[assignment]  # not the method of a tuple


@pytree
class Freeze:
    """See :func:`freeze`."""

    inner: Any
    values: Any
    mask: tuple[bool, ...] = static()

    def init(self, key: jax.Array, num_dims: Any, dtype: Any = None) -> FreezeState:
        """The wrapped optimizer with as many dimensions as are free."""
        num_dims = dimensions(num_dims)
        if num_dims != len(self.mask):
            raise InputError(
                f"mask has {len(self.mask)} entries, the space {num_dims} coordinates."
            )
        inner = self.inner.init(fold(key, 1), len(self._free), dtype=dtype)
        return self._state(inner, jnp.zeros((), jnp.int32))

    def begin(self, key: jax.Array, state: FreezeState, points: jax.Array, spread: Any):
        """Begin at the free coordinates of the points."""
        inner = begin(self.inner, key, state.inner, points[:, self._free], spread)
        return self._state(inner, state.count)

    def update(self, key: jax.Array, state: FreezeState, value: jax.Array):
        """Update the wrapped optimizer in the free coordinates."""
        inner = replace(state.inner, position=state.position[:, self._free])
        inner, info = self.inner.update(fold(key, 1), inner, value)
        return self._state(inner, state.count + 1), info

    @property
    def _free(self) -> np.ndarray:
        return np.flatnonzero(~np.array(self.mask))

    def _state(self, inner, count):
        def widen(x):
            values = jnp.asarray(self.values, x.dtype)
            full = jnp.broadcast_to(values, (*x.shape[:-1], len(self.mask)))
            return full.at[..., self._free].set(x)

        best = widen(inner.best_position), inner.best_value
        return FreezeState(inner, widen(inner.position), *best, count)


def freeze(inner: Any, mask: Any, position: Any) -> Freeze:
    """Wrap an optimizer so that the coordinates where ``mask`` is true stay at ``position``.

    Args:
      inner: any optimizer, wrapped ones included.
      mask: (d,) bools, not all true; part of the program.
      position: (d,) point of the unit cube (``space.encode(params)``); free coordinates are
        ignored.

    >>> from jaxswarm.swarm import pso
    >>> state = freeze(pso(10), [True, False], [0.25, 0.0]).init(jax.random.key(0), 2)
    >>> bool((state.position[:, 0] == 0.25).all())
    True
    """
    mask = tuple(bool(m) for m in np.atleast_1d(mask))
    if all(mask):
        raise InputError("mask freezes every coordinate: leave at least one free.")
    if not isinstance(position, jax.Array):
        position = np.asarray(position, float)
        held = position[np.array(mask)] if position.shape == (len(mask),) else position
        if position.shape != (len(mask),) or not ((held >= 0.0) & (held <= 1.0)).all():
            raise InputError(f"position={position} must hold {len(mask)} numbers in [0, 1].")
    return Freeze(as_optimizer(inner), position, mask)
