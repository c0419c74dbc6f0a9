"""Where a search begins: a point, a population, or a point with a step size, in the space's units."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.swarm.optimizers.beginning import begin
from jaxswarm.swarm.pytree import pytree
from jaxswarm.swarm.random import fold
from jaxswarm.swarm.schedules import coefficient
from jaxswarm.swarm.space import Space

__all__ = ["Start", "around", "begun", "points_of"]

STREAM = 0x57A27
"""What is folded into the key of a search for the spread of its first candidates."""
ROUNDING = 1e-6
"""How far outside the cube a point may lie that was on a bound before it was encoded in float32."""


@pytree
class Start:
    """See :func:`around`."""

    params: Any
    spread: Any


def around(params: Any, spread: float) -> Start:
    """Begin at some parameters with a first step size.

    Args:
      params: one point (as ``space.decode`` returns it) or a population of k with a leading axis.
      spread: standard deviation of the other candidates around the points, and the first sigma of
        ``cma_es``, as a share of every coordinate's range (unit cube).

    >>> space = Space(x=(-5.0, 5.0))
    >>> from jaxswarm.swarm import cma_es, minimize
    >>> found = minimize(
    ...     lambda p, _: p["x"] ** 2, cma_es(), space, jax.random.key(0), num_steps=1,
    ...     start=around({"x": 1e-3}, 0.01),
    ... )
    >>> bool(found.value < 2e-6)
    True
    """
    return Start(params, coefficient("spread", spread, lower=0.0))


def points_of(space: Space, params: Any) -> jax.Array:
    """Encode one point or a population: (k, d) of the unit cube.

    Raises:
      InputError: other parameters than the space's, or some outside its bounds.
    """
    leaves, rank = jax.tree.leaves(params), len(space.shapes[0])
    many = bool(leaves) and np.ndim(leaves[0]) == rank + 1
    if many and not np.shape(leaves[0])[0]:
        raise InputError("start holds no points: give at least one, or no start.")
    # A start is numbers of the host by its nature, which no transfer guard is meant for.
    with jax.transfer_guard_host_to_device("allow"):
        points = jax.vmap(space.encode)(params) if many else space.encode(params)[None]
        clipped = jnp.clip(points, 0.0, 1.0)
    if isinstance(points, jax.core.Tracer):
        return clipped
    found = jax.device_get(points)
    outside = np.argwhere(~((found >= -ROUNDING) & (found <= 1 + ROUNDING)))
    if outside.size:
        row, column = outside[0]
        value = np.asarray(space.lower)[column], np.asarray(space.upper)[column]
        raise InputError(
            f"start: {space.names[column]} of point {row} is not within its bounds {value[0]} and "
            f"{value[1]}: move it inside or widen the space."
        )
    return clipped


def begun(optimizer: Any, key: jax.Array, space: Space, start: Any) -> Any:
    """The first state of a search; ``start`` is None, or ``(points (k, d), spread)``."""
    state = optimizer.init(key, space.size, dtype=space.dtype)
    if start is None:
        return state
    return begin(optimizer, fold(key, STREAM), state, *start)
