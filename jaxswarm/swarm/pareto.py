r"""Several objectives at once: who dominates whom, how crowded a front is, what a front is worth.

A candidate dominates another if no objective is higher and one is lower. Ranks number the fronts that
remain when those before are taken away; the crowding distance of a candidate is the size of the box its
neighbors along the front span, in units of the front's range. The hypervolume is the volume that a front
dominates below a reference point: it grows with every candidate that is better anywhere.

References:
    K. Deb, A. Pratap, S. Agarwal, T. Meyarivan, "A fast and elitist multiobjective genetic algorithm:
    NSGA-II", IEEE Trans. Evol. Comput. 6 (2002), doi 10.1109/4235.996017 (ranks, crowding); E. Zitzler,
    L. Thiele, "Multiobjective evolutionary algorithms: a comparative case study", IEEE Trans. Evol.
    Comput. 3 (1999), doi 10.1109/4235.797969 (hypervolume); L. While, P. Hingston, L. Barone, S. Huband,
    "A faster algorithm for calculating hypervolume", IEEE Trans. Evol. Comput. 10 (2006) (by slices).
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.swarm.pytree import on_device

__all__ = ["Front", "crowding", "dominates", "front", "hypervolume", "ranks", "survivors"]


def dominates(first: jax.Array, second: jax.Array) -> jax.Array:
    """Whether values (..., k) dominate others: (...,) bool."""
    return jnp.all(first <= second, axis=-1) & jnp.any(first < second, axis=-1)


def ranks(values: jax.Array) -> jax.Array:
    """Number of the front of every candidate, (n,) int32 from 0, for values (n, k).

    >>> ranks(jnp.array([[1.0, 2.0], [2.0, 1.0], [2.0, 2.0], [3.0, 3.0]])).tolist()
    [0, 0, 1, 2]
    """
    above = dominates(values[:, None], values[None])  # [i, j]: i dominates j
    n = values.shape[0]

    def left(state):
        return jnp.any(state[1] == n)

    def peel(state):
        number, rank = state
        open_ = rank == n
        beaten = jnp.any(above & open_[:, None], axis=0)
        return number + 1, jnp.where(open_ & ~beaten, number, rank)

    start = jnp.int32(0), jnp.full((n,), n, jnp.int32)
    return jax.lax.while_loop(left, peel, start)[1]


def crowding(values: jax.Array, rank: jax.Array) -> jax.Array:
    """Crowding distance (n,) within the fronts of ``rank`` (n,); +inf at the ends of a front.

    >>> values = jnp.array([[0.0, 4.0], [1.0, 2.0], [4.0, 0.0]])
    >>> crowding(values, ranks(values)).tolist()
    [inf, 2.0, inf]
    """
    n = values.shape[0]
    finite = jnp.where(jnp.isfinite(values), values, jnp.finfo(values.dtype).max / 4)

    def along(column):
        high = jax.ops.segment_max(column, rank, num_segments=n)
        low = jax.ops.segment_min(column, rank, num_segments=n)
        order = jnp.lexsort((column, rank))
        value, group = column[order], rank[order]
        inner = (group[1:-1] == group[:-2]) & (group[1:-1] == group[2:])
        spread = jnp.where(high > low, high - low, 1.0)[group[1:-1]]
        gap = jnp.where(inner, (value[2:] - value[:-2]) / spread, jnp.inf)
        gap = jnp.concatenate([jnp.full(1, jnp.inf), gap, jnp.full(1, jnp.inf)])[:n]
        return jnp.zeros(n, values.dtype).at[order].set(gap.astype(values.dtype))

    return sum(along(finite[:, k]) for k in range(values.shape[1]))


def survivors(values: jax.Array, num: int) -> jax.Array:
    """Indices (num,) of the best of (n, k): by front, within one the less crowded first."""
    rank = ranks(values)
    return jnp.lexsort((-crowding(values, rank), rank))[:num]


class Front(NamedTuple):
    """Candidates that nothing found dominates.

    Attributes:
      params: as the space decodes a population, leading axis m; values: (m, k), sorted by the first.
      position: (m, d) of the unit cube.
    """

    params: Any
    values: np.ndarray
    position: np.ndarray


def front(result: Any, space: Any) -> Front:
    """The front of a search with ``nsga2`` or ``mopso``; of many runs the front of all together.

    Args:
      result: a ``Result``, or its final state.
      space: the space of the search.
    """
    state = getattr(result, "state", result)
    while not hasattr(state, "FRONT") and hasattr(state, "inner"):
        state = state.inner
    if not hasattr(state, "FRONT"):
        raise InputError(f"{type(state).__name__} holds no front: search with nsga2() or mopso().")
    position, values = jax.device_get([getattr(state, name) for name in state.FRONT])
    position, values = (
        position.reshape(-1, position.shape[-1]),
        values.reshape(-1, values.shape[-1]),
    )
    finite = np.isfinite(values).all(axis=1)
    values, first = np.unique(values[finite], axis=0, return_index=True)
    position = position[finite][first]
    if values.size:
        kept = jax.device_get(_ranks(jax.device_put(values))) == 0
        values, position = values[kept], position[kept]
    params = jax.device_get(_decoded(on_device(space), jax.device_put(position)))
    return Front(params, values, position)


_ranks = jax.jit(ranks)


@jax.jit
def _decoded(space, position):
    return jax.vmap(space.decode)(position)


def hypervolume(values: Any, reference: Any) -> float:
    """Volume that values (m, k) dominate within the reference point (k,); exact, on the host.

    Takes about m^(k - 1) log m operations: fronts of hundreds in two objectives, of some dozens in four.

    >>> hypervolume([[1.0, 3.0], [2.0, 2.0], [3.0, 1.0]], [4.0, 4.0])
    6.0
    """
    values, reference = np.asarray(values, float), np.asarray(reference, float)
    if values.ndim != 2 or reference.shape != values.shape[1:]:
        raise InputError(
            f"values have shape {values.shape}, reference {reference.shape}: give (m, k) and (k,)."
        )
    return _volume(values[(values < reference).all(axis=1)], reference)


def _volume(values, reference):
    if not len(values):
        return 0.0
    if values.shape[1] == 1:
        return float(reference[0] - values.min())
    values = values[np.argsort(values[:, -1], kind="stable")]
    if values.shape[1] == 2:
        lowest = np.minimum.accumulate(values[:, 0])
        ends = np.append(values[1:, 1], reference[1])
        return float(((reference[0] - lowest) * (ends - values[:, 1])).sum())
    ends = np.append(values[1:, -1], reference[-1])
    slices = zip(range(1, len(values) + 1), ends - values[:, -1], strict=True)
    return float(
        sum(_volume(values[:i, :-1], reference[:-1]) * height for i, height in slices if height > 0)
    )
